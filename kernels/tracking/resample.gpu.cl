// Cuts targets' windows out of a picture and brings them to patches of side x side pixels: bilinear
// samples in integers, the mean of several where the window is larger than the patch, so that a
// near target is not aliased. Result: grey levels with four fractional bits. Assumes: side a
// multiple of 16; picture and window within +-32767 px. GPU variant: a work-item per pixel, groups
// of 16 x 16, patches along z.
#include "tracking/sample.clh"

__kernel __attribute__((reqd_work_group_size(16, 16, 1))) void resample(
    __global const uchar* restrict image, __global const int* restrict windows,
    __global ushort* restrict patches, int width, int height, int side, int count) {
  const int i = (int)get_global_id(0);
  const int j = (int)get_global_id(1);
  const int p = (int)get_global_id(2);
  if (p >= count) return;
  __global const int* window = windows + p * WINDOW_ENTRIES;
  const int shift = window[4];
  patches[((size_t)p * (size_t)side + (size_t)j) * (size_t)side + (size_t)i] =
      mean_of_taps(image, width, height, window[0] + i * window[2], window[1] + j * window[3],
                   window[2] >> shift, window[3] >> shift, shift);
}
