// Gaussian of 7 x 7 (see the GPU's text for what it is).
// Assumes: 1 <= width <= 4096, height >= 1; stride == width.
// One work-item per band of 32 rows: each row's column sums go into a line of its own, then along
// the line, by loops without a branch, of which the compiler makes full vectors. All sums fit 16
// bits unsigned: the weights add up to 256.
#include "frontend/common.clh"

#define BAND 32
#define PAD 16

static inline void blur_columns(__global const uchar* r0, __global const uchar* r1,
                                __global const uchar* r2, __global const uchar* r3,
                                __global const uchar* r4, __global const uchar* r5,
                                __global const uchar* r6, __private uchar* sums, int width) {
  for (int x = 0; x < width; ++x) {
    sums[x] = blur_tap(r0[x], r1[x], r2[x], r3[x], r4[x], r5[x], r6[x]);
  }
}

// In two passes, of every second input each: where a loop reads neighbours, the compiler carries
// values over from one iteration to the next, and then makes no vectors.
static inline void blur_row(__private const uchar* s, __private ushort* part, __global uchar* out,
                            int width) {
  for (int x = 0; x < width; ++x) {
    part[x] = (ushort)((s[x] + s[x + 6]) * 18 + (s[x + 2] + s[x + 4]) * 49 + 128);
  }
  for (int x = 0; x < width; ++x) {
    out[x] = (uchar)((ushort)(part[x] + (s[x + 1] + s[x + 5]) * 33 + s[x + 3] * 56) >> 8);
  }
}

// The column sums of row y, with the edge's repeated three times at either end.
static inline void sum_columns(__global const uchar* src, __private uchar* sums, int y, int width,
                               int height) {
  blur_columns(src + max(y - 3, 0) * width, src + max(y - 2, 0) * width,
               src + max(y - 1, 0) * width, src + y * width, src + min(y + 1, height - 1) * width,
               src + min(y + 2, height - 1) * width, src + min(y + 3, height - 1) * width, sums,
               width);
  for (int i = 1; i <= 3; ++i) {
    sums[-i] = sums[0];
    sums[width - 1 + i] = sums[width - 1];
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void gaussian_blur(
    __global const uchar* restrict src, __global uchar* restrict dst, int width, int height) {
  uchar line[PAD + 4096 + PAD];
  ushort part[4096];
  const int first = (int)get_global_id(0) * BAND;
  const int last = min(first + BAND, height);
  for (int y = first; y < last; ++y) {
    sum_columns(src, line + PAD, y, width, height);
    blur_row(line + PAD - 3, part, dst + y * width, width);
  }
}
