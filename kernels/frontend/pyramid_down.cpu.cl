// Reduces an image to 5/6 of its size by bilinear interpolation in fixed point (see the GPU's
// text).
// Assumes: 6 <= width <= 4096, height >= 6; stride == width.
// One work-item per band of 16 output rows. Each row first blends the two source rows by vectors
// into a line of its own, then the columns, whose weights repeat every five.
#include "frontend/common.clh"

#define BAND 16

static inline ushort blend_columns(ushort a, ushort b, uint wx) {
  return (ushort)((a * (32u - wx) + b * wx + 512u) >> 10);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void pyramid_down(
    __global const uchar* restrict src, __global uchar* restrict dst, int width, int height) {
  ushort line[4096 + 16];
  const int out_width = width * 5 / 6;
  const int out_height = height * 5 / 6;
  const int first = (int)get_global_id(0) * BAND;
  const int last = min(first + BAND, out_height);
  for (int y = first; y < last; ++y) {
    const ushort wy = DOWN_WEIGHT[y % 5];
    __global const uchar* top = src + y * 6 / 5 * width;
    __global const uchar* bottom = top + width;
    int x = 0;
    for (; x + 16 <= width; x += 16) {
      const ushort16 blended = convert_ushort16(vload16(0, top + x)) * (ushort16)(ushort)(32 - wy) +
                               convert_ushort16(vload16(0, bottom + x)) * (ushort16)wy;
      vstore16(blended, 0, line + x);
    }
    for (; x < width; ++x) line[x] = (ushort)(top[x] * (32 - wy) + bottom[x] * wy);

    __global uchar* out = dst + y * out_width;
    __private const ushort* from = line;
    int column = 0;
    for (; column + 5 <= out_width; column += 5, from += 6) {
      out[column] = (uchar)blend_columns(from[0], from[1], 3);
      out[column + 1] = (uchar)blend_columns(from[1], from[2], 10);
      out[column + 2] = (uchar)blend_columns(from[2], from[3], 16);
      out[column + 3] = (uchar)blend_columns(from[3], from[4], 22);
      out[column + 4] = (uchar)blend_columns(from[4], from[5], 29);
    }
    for (int r = 0; column + r < out_width; ++r) {
      out[column + r] = (uchar)blend_columns(from[r], from[r + 1], DOWN_WEIGHT[r]);
    }
  }
}
