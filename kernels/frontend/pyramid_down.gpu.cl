// Reduces an image to 5/6 of its size by bilinear interpolation in fixed point.
// Assumes: width, height >= 6; stride == width; dst is (width * 5 / 6) x (height * 5 / 6). Pixel 5
// q + r of the result lies between source pixels 6 q + r and 6 q + r + 1, so no source pixel is
// clamped. One work-item per output pixel in groups of 32 x 8; the source rows are read coalesced,
// and every source pixel by at most four neighbours of one group, which the cache serves.
#include "frontend/common.clh"

__kernel __attribute__((reqd_work_group_size(32, 8, 1))) void pyramid_down(
    __global const uchar* restrict src, __global uchar* restrict dst, int width, int height) {
  const int x = (int)get_global_id(0);
  const int y = (int)get_global_id(1);
  const int out_width = width * 5 / 6;
  const int out_height = height * 5 / 6;
  if (x >= out_width || y >= out_height) return;
  const int wx = DOWN_WEIGHT[x % 5];
  const int wy = DOWN_WEIGHT[y % 5];
  __global const uchar* p = src + y * 6 / 5 * width + x * 6 / 5;
  dst[y * out_width + x] = blend_down(p[0], p[1], p[width], p[width + 1], wx, wy);
}
