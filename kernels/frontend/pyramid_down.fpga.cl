// Reduces an image to 5/6 of its size by bilinear interpolation in fixed point (see the GPU's
// text).
// Assumes: 6 <= width <= 4096, height >= 6; stride == width.
// Streams the source once, six pixels and hence five outputs per cycle: outputs 5 q .. 5 q + 4 need
// source pixels 6 q .. 6 q + 5 and no others. One line buffer holds the row above; nothing is
// carried from one iteration to the next but the line buffer, read and written at the same address:
// II = 1.
#include "common/fpga.clh"
#include "frontend/common.clh"

#define MAX_WORDS 683  // 4096 / 6, rounded up

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void pyramid_down(
    __global const uchar* restrict src, __global uchar* restrict dst, int width, int height) {
  uchar above[MAX_WORDS][6] PARTITION_COMPLETE(2);
  const int out_width = width * 5 / 6;
  const int out_height = height * 5 / 6;
  const int words = (width + 5) / 6;
  int row = 0;    // of the result
  int phase = 5;  // (y - 1) % 6: 5 is the source row that starts no output
  for (int y = 0; y < height; ++y) {
    PIPELINE(1)
    for (int q = 0; q < words; ++q) {
      uchar now[6];
      UNROLL(6)
      for (int i = 0; i < 6; ++i) {
        const int x = 6 * q + i;
        now[i] = x < width ? src[y * width + x] : (uchar)0;
      }
      UNROLL(5)
      for (int r = 0; r < 5; ++r) {
        const int x = 5 * q + r;
        if (phase != 5 && row < out_height && x < out_width) {
          dst[row * out_width + x] = blend_down(above[q][r], above[q][r + 1], now[r], now[r + 1],
                                                DOWN_WEIGHT[r], DOWN_WEIGHT[phase]);
        }
      }
      UNROLL(6)
      for (int i = 0; i < 6; ++i) above[q][i] = now[i];
    }
    if (phase != 5) ++row;
    phase = phase == 5 ? 0 : phase + 1;
  }
}
