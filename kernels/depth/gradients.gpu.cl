// Sobel gradients and descriptors, GPU variant.
// Assumes: pictures without row padding; any size; work-groups of 32 x 8, the NDRange rounded up to
// them. Each group holds its pixels and their neighbourhood in local memory; edges repeat.
#include "depth/constants.clh"

#define TILE_X 32
#define TILE_Y 8

static inline uchar squeeze(int response) {
  return (uchar)clamp(128 + (response >> 2), 0, 255);
}

// Fills a tile of (TILE_X + 2 reach) x (TILE_Y + 2 reach) pixels around the work-group's own.
ALWAYS_INLINE void load_tile(__global const uchar* image, int width, int height,
                             __local uchar* tile, int reach) {
  const int columns = TILE_X + 2 * reach;
  const int left = (int)get_group_id(0) * TILE_X - reach;
  const int top = (int)get_group_id(1) * TILE_Y - reach;
  for (int j = (int)get_local_id(1); j < TILE_Y + 2 * reach; j += TILE_Y) {
    const size_t row = (size_t)clamp(top + j, 0, height - 1) * (size_t)width;
    for (int i = (int)get_local_id(0); i < columns; i += TILE_X) {
      tile[j * columns + i] = image[row + (size_t)clamp(left + i, 0, width - 1)];
    }
  }
}

__kernel __attribute__((reqd_work_group_size(TILE_X, TILE_Y, 1))) void sobel(
    __global const uchar* restrict image, __global uchar* restrict du, __global uchar* restrict dv,
    int width, int height) {
  __local uchar tile[(TILE_X + 2) * (TILE_Y + 2)];
  load_tile(image, width, height, tile, 1);
  barrier(CLK_LOCAL_MEM_FENCE);
  const int x = (int)get_global_id(0);
  const int y = (int)get_global_id(1);
  if (x >= width || y >= height) return;
  const int stride = TILE_X + 2;
  __local const uchar* p = tile + (int)get_local_id(1) * stride + (int)get_local_id(0);
  const int first = p[0];
  const int third = p[2];
  const int seventh = p[2 * stride];
  const int ninth = p[2 * stride + 2];
  const int sides = 2 * (p[stride + 2] - p[stride]);
  const int ends = 2 * (p[2 * stride + 1] - p[1]);
  const size_t i = (size_t)y * (size_t)width + (size_t)x;
  du[i] = squeeze(third + ninth - first - seventh + sides);
  dv[i] = squeeze(seventh + ninth - first - third + ends);
}

__kernel __attribute__((reqd_work_group_size(TILE_X, TILE_Y, 1))) void descriptor(
    __global const uchar* restrict du, __global const uchar* restrict dv,
    __global uchar* restrict descriptors, int width, int height) {
  __local uchar du_tile[(TILE_X + 4) * (TILE_Y + 4)];
  __local uchar dv_tile[(TILE_X + 2) * (TILE_Y + 2)];
  load_tile(du, width, height, du_tile, 2);
  load_tile(dv, width, height, dv_tile, 1);
  barrier(CLK_LOCAL_MEM_FENCE);
  const int x = (int)get_global_id(0);
  const int y = (int)get_global_id(1);
  if (x >= width || y >= height) return;
  const int s = TILE_X + 4;
  const int t = TILE_X + 2;
  __local const uchar* u = du_tile + (int)get_local_id(1) * s + (int)get_local_id(0);
  __local const uchar* v = dv_tile + (int)get_local_id(1) * t + (int)get_local_id(0);
  const uchar16 samples = (uchar16)(u[1], u[3], u[s + 1], u[s + 2], u[s + 3], u[2 * s + 1],
                                    u[2 * s + 3], u[3 * s + 1], u[3 * s + 2], u[3 * s + 3],
                                    u[4 * s + 1], u[4 * s + 3], v[1], v[t], v[t + 2], v[2 * t + 1]);
  vstore16(samples, (size_t)y * (size_t)width + (size_t)x, descriptors);
}
