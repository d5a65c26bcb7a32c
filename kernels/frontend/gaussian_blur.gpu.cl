// Gaussian of 7 x 7, sigma 2: down the columns, then along the rows, each rounded to 8 bits; the
// edge's pixels are repeated outwards.
// Assumes: stride == width; any size from 1 x 1.
// Groups of 32 x 8 with their 38 x 14 neighbourhood in local memory.
#include "frontend/common.clh"

#define TILE_X 32
#define TILE_Y 8
#define HALO_X (TILE_X + 6)
#define HALO_Y (TILE_Y + 6)

__kernel __attribute__((reqd_work_group_size(TILE_X, TILE_Y, 1))) void gaussian_blur(
    __global const uchar* restrict src, __global uchar* restrict dst, int width, int height) {
  __local uchar tile[HALO_Y * HALO_X];
  __local uchar columns[TILE_Y * HALO_X];
  const int left = (int)get_group_id(0) * TILE_X - 3;
  const int top = (int)get_group_id(1) * TILE_Y - 3;
  const int lane = (int)get_local_id(1) * TILE_X + (int)get_local_id(0);
  for (int ty = (int)get_local_id(1); ty < HALO_Y; ty += TILE_Y) {
    const int sy = clamp(top + ty, 0, height - 1);
    for (int tx = (int)get_local_id(0); tx < HALO_X; tx += TILE_X) {
      tile[ty * HALO_X + tx] = src[sy * width + clamp(left + tx, 0, width - 1)];
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = lane; i < TILE_Y * HALO_X; i += TILE_X * TILE_Y) {
    __local const uchar* p = tile + i;
    columns[i] = blur_tap(p[0], p[HALO_X], p[2 * HALO_X], p[3 * HALO_X], p[4 * HALO_X],
                          p[5 * HALO_X], p[6 * HALO_X]);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const int x = (int)get_global_id(0);
  const int y = (int)get_global_id(1);
  if (x >= width || y >= height) return;
  __local const uchar* p = columns + (int)get_local_id(1) * HALO_X + (int)get_local_id(0);
  dst[y * width + x] = blur_tap(p[0], p[1], p[2], p[3], p[4], p[5], p[6]);
}
