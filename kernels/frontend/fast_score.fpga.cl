// FAST-9 scores (see the GPU's text for what they are).
// Assumes: width <= 4096; stride == width; 0 <= threshold <= 255; any height.
// Streams the image, four pixels per cycle, through six line buffers and a window of 7 x 10 in
// registers. The only value carried from iteration to iteration is the window, shifted by four, and
// the line buffers, read and written at the same address: II = 1.
#include "common/fpga.clh"
#include "frontend/common.clh"
#include "frontend/fast.clh"

#define LANES 4
#define MAX_WIDTH 4096

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void fast_score(
    __global const uchar* restrict src, __global uchar* restrict score, int width, int height,
    int threshold) {
  uchar lines[6][MAX_WIDTH + 2 * LANES] PARTITION_COMPLETE(1) PARTITION_CYCLIC(LANES, 2);
  uchar window[7][LANES + 6] PARTITION_COMPLETE(0);
  for (int r = 0; r < 7; ++r) {
    for (int i = 0; i < LANES + 6; ++i) window[r][i] = 0;
  }
  for (int r = 0; r < 6; ++r) {
    for (int i = 0; i < width + 2 * LANES; ++i) lines[r][i] = 0;
  }
  // Three rows and three columns late: rows run to height + 3, words one beyond the width.
  const int words = (width + LANES + 2) / LANES;
  for (int y = 0; y < height + 3; ++y) {
    PIPELINE(1)
    for (int q = 0; q < words; ++q) {
      UNROLL(7)
      for (int r = 0; r < 7; ++r) {
        UNROLL(6)
        for (int i = 0; i < 6; ++i) window[r][i] = window[r][i + LANES];
      }
      UNROLL(LANES)
      for (int l = 0; l < LANES; ++l) {
        const int x = q * LANES + l;
        UNROLL(6)
        for (int r = 0; r < 6; ++r) window[r][6 + l] = lines[r][x];
        window[6][6 + l] = x < width && y < height ? src[y * width + x] : (uchar)0;
        UNROLL(6)
        for (int r = 0; r < 6; ++r) lines[r][x] = window[r + 1][6 + l];
      }
      UNROLL(LANES)
      for (int l = 0; l < LANES; ++l) {
        const int x = q * LANES + l - 3;
        const int row = y - 3;
        const int c = window[3][l + 3];
        int result;
#define AT(dx, dy) ((int)window[3 + (dy)][l + 3 + (dx)])
        FAST9_SCORE(result, int, c, AT)
#undef AT
        const int inside = x >= 3 && row >= 3 && x < width - 3 && row < height - 3;
        if (x >= 0 && x < width && row >= 0) {
          score[row * width + x] = inside && result > threshold ? (uchar)result : (uchar)0;
        }
      }
    }
  }
}
