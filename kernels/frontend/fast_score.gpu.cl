// FAST-9: for each pixel the largest t such that nine contiguous pixels of the sixteen on the
// circle of radius 3 are all brighter, or all darker, than the centre by more than t - 1; 0 where
// that is not above `threshold`, and in the border of 3 pixels.
// Assumes: stride == width; 0 <= threshold <= 255; any size (below 7 x 7 the result is all zero).
// Groups of 32 x 8 with their 38 x 14 neighbourhood in local memory.
#include "frontend/common.clh"
#include "frontend/fast.clh"

#define TILE_X 32
#define TILE_Y 8
#define HALO_X (TILE_X + 6)
#define HALO_Y (TILE_Y + 6)

__kernel __attribute__((reqd_work_group_size(TILE_X, TILE_Y, 1))) void fast_score(
    __global const uchar* restrict src, __global uchar* restrict score, int width, int height,
    int threshold) {
  __local uchar tile[HALO_Y * HALO_X];
  const int left = (int)get_group_id(0) * TILE_X - 3;
  const int top = (int)get_group_id(1) * TILE_Y - 3;
  for (int ty = (int)get_local_id(1); ty < HALO_Y; ty += TILE_Y) {
    const int sy = clamp(top + ty, 0, height - 1);
    for (int tx = (int)get_local_id(0); tx < HALO_X; tx += TILE_X) {
      tile[ty * HALO_X + tx] = src[sy * width + clamp(left + tx, 0, width - 1)];
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);

  const int x = (int)get_global_id(0);
  const int y = (int)get_global_id(1);
  if (x >= width || y >= height) return;
  __local const uchar* p =
      tile + ((int)get_local_id(1) + 3) * HALO_X + (int)get_local_id(0) + 3;
  const int c = p[0];
  int result;
#define AT(dx, dy) ((int)p[(dy) * HALO_X + (dx)])
  FAST9_SCORE(result, int, c, AT)
#undef AT
  const int inside = x >= 3 && y >= 3 && x < width - 3 && y < height - 3;
  score[y * width + x] = inside && result > threshold ? (uchar)result : (uchar)0;
}
