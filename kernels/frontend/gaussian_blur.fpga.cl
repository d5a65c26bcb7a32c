// Gaussian of 7 x 7 (see the GPU's text for what it is).
// Assumes: 1 <= width <= 4096, height >= 1; stride == width.
// Streams the image, four pixels per cycle, through six line buffers; the column sums go through a
// shift register of ten. Carried between iterations: the shift register and the line buffers, read
// and written at the same address: II = 1. Edges repeat: the first row fills all line buffers, rows
// below the last and columns right of it repeat what came last.
#include "common/fpga.clh"
#include "frontend/common.clh"

#define LANES 4
#define MAX_WIDTH 4096

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void gaussian_blur(
    __global const uchar* restrict src, __global uchar* restrict dst, int width, int height) {
  uchar lines[6][MAX_WIDTH + 2 * LANES] PARTITION_COMPLETE(1) PARTITION_CYCLIC(LANES, 2);
  uchar sums[LANES + 6] PARTITION_COMPLETE(0);
  const int words = (width + LANES + 2) / LANES;
  for (int i = 0; i < LANES + 6; ++i) sums[i] = 0;
  for (int r = 0; r < 6; ++r) {
    for (int i = 0; i < width + 2 * LANES; ++i) lines[r][i] = 0;
  }
  for (int y = 0; y < height + 3; ++y) {
    PIPELINE(1)
    for (int q = 0; q < words; ++q) {
      UNROLL(6)
      for (int i = 0; i < 6; ++i) sums[i] = sums[i + LANES];
      UNROLL(LANES)
      for (int l = 0; l < LANES; ++l) {
        const int x = q * LANES + l;
        uchar column[7];
        UNROLL(6)
        for (int r = 0; r < 6; ++r) column[r] = lines[r][x];
        column[6] = y < height && x < width ? src[y * width + x] : column[5];
        if (y == 0) {
          UNROLL(6)
          for (int r = 0; r < 6; ++r) column[r] = column[6];
        }
        UNROLL(6)
        for (int r = 0; r < 6; ++r) lines[r][x] = column[r + 1];
        const uchar sum = blur_tap(column[0], column[1], column[2], column[3], column[4], column[5],
                                   column[6]);
        sums[6 + l] = x < width ? sum : sums[5 + l];
      }
      if (q == 0) {
        UNROLL(6)
        for (int i = 0; i < 6; ++i) sums[i] = sums[6];
      }
      UNROLL(LANES)
      for (int l = 0; l < LANES; ++l) {
        const int x = q * LANES + l - 3;
        if (y >= 3 && x >= 0 && x < width) {
          dst[(y - 3) * width + x] = blur_tap(sums[l], sums[l + 1], sums[l + 2], sums[l + 3],
                                              sums[l + 4], sums[l + 5], sums[l + 6]);
        }
      }
    }
  }
}
