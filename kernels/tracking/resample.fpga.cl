// Cuts targets' windows out of a picture (see the GPU's text for how).
// Assumes: as there. FPGA variant: one work-item, one tap after the other; its four pixels come
// through one port, so a tap starts every four clocks.
#include "common/fpga.clh"
#include "tracking/sample.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void resample(
    __global const uchar* restrict image, __global const int* restrict windows,
    __global ushort* restrict patches, int width, int height, int side, int count) {
  for (int p = 0; p < count; ++p) {
    const int x0 = windows[p * WINDOW_ENTRIES];
    const int y0 = windows[p * WINDOW_ENTRIES + 1];
    const int step_x = windows[p * WINDOW_ENTRIES + 2];
    const int step_y = windows[p * WINDOW_ENTRIES + 3];
    const int shift = windows[p * WINDOW_ENTRIES + 4];
    const int taps = 1 << shift;
    const int pitch_x = step_x >> shift;
    const int pitch_y = step_y >> shift;
    const int left = x0 - pitch_x * (taps - 1) / 2;
    const int top = y0 - pitch_y * (taps - 1) / 2;
    int i = 0;
    int j = 0;
    int u = 0;
    int v = 0;
    int sum = 0;
    PIPELINE(4)
    for (int t = 0; t < (side * side) << (2 * shift); ++t) {
      sum += bilinear(image, width, height, left + i * step_x + u * pitch_x,
                      top + j * step_y + v * pitch_y);
      if (++u < taps) continue;
      u = 0;
      if (++v < taps) continue;
      v = 0;
      patches[((size_t)p * (size_t)side + (size_t)j) * (size_t)side + (size_t)i] =
          (ushort)((sum + (taps * taps) / 2) >> (2 * shift));
      sum = 0;
      if (++i < side) continue;
      i = 0;
      ++j;
    }
  }
}
