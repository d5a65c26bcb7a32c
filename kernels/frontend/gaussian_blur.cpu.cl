// Gaussian of 7 x 7 (see the GPU's text for what it is).
// Assumes: 1 <= width <= 4096, height >= 1; stride == width.
// One work-item per band of 32 rows: each row's column sums go into a line of its own, sixteen at a
// time, then along the line. All sums fit 16 bits unsigned: the weights add up to 256.
#include "frontend/common.clh"

#define BAND 32
#define PAD 16
#define WIDE(p) convert_ushort16(vload16(0, p))

static inline uchar16 tap_vector(ushort16 s06, ushort16 s15, ushort16 s24, ushort16 s3) {
  const ushort16 sum = s06 * (ushort16)(18) + s15 * (ushort16)(33) + s24 * (ushort16)(49) +
                       s3 * (ushort16)(56) + (ushort16)(128);
  return convert_uchar16(sum >> (ushort16)(8));
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void gaussian_blur(
    __global const uchar* restrict src, __global uchar* restrict dst, int width, int height) {
  uchar line[PAD + 4096 + 2 * PAD];
  const int first = (int)get_global_id(0) * BAND;
  const int last = min(first + BAND, height);
  for (int y = first; y < last; ++y) {
    __global const uchar* r0 = src + max(y - 3, 0) * width;
    __global const uchar* r1 = src + max(y - 2, 0) * width;
    __global const uchar* r2 = src + max(y - 1, 0) * width;
    __global const uchar* r3 = src + y * width;
    __global const uchar* r4 = src + min(y + 1, height - 1) * width;
    __global const uchar* r5 = src + min(y + 2, height - 1) * width;
    __global const uchar* r6 = src + min(y + 3, height - 1) * width;
    __private uchar* sums = line + PAD;
    int x = 0;
    for (; x + 16 <= width; x += 16) {
      vstore16(tap_vector(WIDE(r0 + x) + WIDE(r6 + x), WIDE(r1 + x) + WIDE(r5 + x),
                          WIDE(r2 + x) + WIDE(r4 + x), WIDE(r3 + x)),
               0, sums + x);
    }
    for (; x < width; ++x) {
      sums[x] = blur_tap(r0[x], r1[x], r2[x], r3[x], r4[x], r5[x], r6[x]);
    }
    for (int i = 1; i <= 3; ++i) {
      sums[-i] = sums[0];
      sums[width - 1 + i] = sums[width - 1];
    }
    __global uchar* out = dst + y * width;
    __private const uchar* s = sums - 3;
    x = 0;
    for (; x + 16 <= width; x += 16, s += 16) {
      vstore16(tap_vector(WIDE(s) + WIDE(s + 6), WIDE(s + 1) + WIDE(s + 5),
                          WIDE(s + 2) + WIDE(s + 4), WIDE(s + 3)),
               0, out + x);
    }
    for (; x < width; ++x, ++s) out[x] = blur_tap(s[0], s[1], s[2], s[3], s[4], s[5], s[6]);
  }
}
