// Cuts targets' windows out of a picture (see the GPU's text for how).
// Assumes: side a multiple of 16, at most MAX_SIDE. CPU variant: a work-item takes BAND rows of a
// patch. Where a sample has a single tap, columns and their weights are the same in all rows: they
// are prepared once.
#include "tracking/sample.clh"

// Sixteen samples of a row, from the pixels at `x0` and `x1` of two rows.
static inline int16 mix(const int16 a, const int16 b, const int16 fx) {
  return a * (256 - fx) + b * fx;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void resample(
    __global const uchar* restrict image, __global const int* restrict windows,
    __global ushort* restrict patches, int width, int height, int side, int count) {
  int left[MAX_SIDE], right[MAX_SIDE], part[MAX_SIDE];
  const int p = (int)get_global_id(1);
  if (p >= count) return;
  const int begin = (int)get_global_id(0) * BAND;
  __global const int* window = windows + p * WINDOW_ENTRIES;
  const int x0 = window[0];
  const int y0 = window[1];
  const int step_x = window[2];
  const int step_y = window[3];
  const int shift = window[4];
  __global ushort* patch = patches + (size_t)p * (size_t)side * (size_t)side;
  if (shift > 0) {
    for (int j = begin; j < begin + BAND; ++j) {
      for (int i = 0; i < side; ++i) {
        patch[j * side + i] = mean_of_taps(image, width, height, x0 + i * step_x, y0 + j * step_y,
                                           step_x >> shift, step_y >> shift, shift);
      }
    }
    return;
  }
  for (int i = 0; i < side; ++i) {
    const int x = x0 + i * step_x;
    left[i] = clamp(x >> 16, 0, width - 1);
    right[i] = clamp((x >> 16) + 1, 0, width - 1);
    part[i] = (x >> 8) & 255;
  }
  for (int j = begin; j < begin + BAND; ++j) {
    const int y = y0 + j * step_y;
    __global const uchar* above = image + (size_t)clamp(y >> 16, 0, height - 1) * (size_t)width;
    __global const uchar* below =
        image + (size_t)clamp((y >> 16) + 1, 0, height - 1) * (size_t)width;
    const int fy = (y >> 8) & 255;
    for (int i = 0; i < side; i += 16) {
      int a[16], b[16], c[16], d[16];
      for (int k = 0; k < 16; ++k) {
        a[k] = above[left[i + k]];
        b[k] = above[right[i + k]];
        c[k] = below[left[i + k]];
        d[k] = below[right[i + k]];
      }
      const int16 fx = vload16(0, part + i);
      const int16 top = mix(vload16(0, a), vload16(0, b), fx);
      const int16 bottom = mix(vload16(0, c), vload16(0, d), fx);
      const int16 value = (top * (256 - fy) + bottom * fy + 2048) >> 12;
      vstore16(convert_ushort16(value), 0, patch + j * side + i);
    }
  }
}
