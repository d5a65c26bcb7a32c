// Adaptive mean and median along rows or columns, GPU variant.
// Assumes: any size; groups of 64 x 4 pixels, the NDRange rounded up to them. Neighbours come from
// the cache. Pixels too near to a line's end stay as they are.
#include "depth/smooth.clh"

#define GROUP_X 64
#define GROUP_Y 4

__kernel __attribute__((reqd_work_group_size(GROUP_X, GROUP_Y, 1))) void adaptive_mean(
    __global const ushort* restrict map, __global ushort* restrict out, int width, int height,
    int vertical) {
  const int x = (int)get_global_id(0);
  const int y = (int)get_global_id(1);
  if (x >= width || y >= height) return;
  const int place = vertical != 0 ? y : x;
  const int length = vertical != 0 ? height : width;
  const int stride = vertical != 0 ? width : 1;
  const int i = y * width + x;
  if (place < MEAN_REACH || place >= length - MEAN_REACH) {
    out[i] = map[i];
    return;
  }
  ushort taps[2 * MEAN_REACH + 1];
  for (int k = 0; k < 2 * MEAN_REACH + 1; ++k) taps[k] = map[i + (k - MEAN_REACH) * stride];
  out[i] = mean_of(taps);
}

__kernel __attribute__((reqd_work_group_size(GROUP_X, GROUP_Y, 1))) void median(
    __global const ushort* restrict map, __global ushort* restrict out, int width, int height,
    int vertical) {
  const int x = (int)get_global_id(0);
  const int y = (int)get_global_id(1);
  if (x >= width || y >= height) return;
  const int place = vertical != 0 ? y : x;
  const int length = vertical != 0 ? height : width;
  const int stride = vertical != 0 ? width : 1;
  const int i = y * width + x;
  if (place < MEDIAN_REACH || place >= length - MEDIAN_REACH) {
    out[i] = map[i];
    return;
  }
  ushort taps[2 * MEDIAN_REACH + 1];
  for (int k = 0; k < 2 * MEDIAN_REACH + 1; ++k) taps[k] = map[i + (k - MEDIAN_REACH) * stride];
  out[i] = median_of(taps);
}
