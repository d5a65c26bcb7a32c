// Orientation and descriptor of every keypoint (see the GPU's text for what they are).
// Assumes: as there.
// One work-item per 16 keypoints. The moments add rows +dy and -dy as vectors: columns -15..0 and
// 1..16 (the last one masked out); the sums fit 16 bits signed: 31 * 255 and 120 * 255. The blurred
// patch is copied to a private array of fixed stride, which the table's offsets index.
#include "frontend/common.clh"

#define PER_ITEM 16

static inline int sum_of(int16 v) {
  const int8 a = v.lo + v.hi;
  const int4 b = a.lo + a.hi;
  return b.x + b.y + b.z + b.w;
}

static inline int direction_bin(__global const uchar* centre, int stride) {
  const short16 left_x =
      (short16)(-15, -14, -13, -12, -11, -10, -9, -8, -7, -6, -5, -4, -3, -2, -1, 0);
  const short16 right_x = (short16)(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
  short16 left_sum = convert_short16(vload16(0, centre - RADIUS));
  short16 right_sum = convert_short16(vload16(0, centre + 1)) & (right_x <= (short16)(RADIUS));
  short16 left_weighted = (short16)(0);
  short16 right_weighted = (short16)(0);
  for (int dy = 1; dy <= RADIUS; ++dy) {
    const short16 reach = (short16)((short)HALF_WIDTH[dy]);
    const short16 in_left = -left_x <= reach;
    const short16 in_right = right_x <= reach;
    __global const uchar* below = centre + dy * stride;
    __global const uchar* above = centre - dy * stride;
    const short16 below_left = convert_short16(vload16(0, below - RADIUS)) & in_left;
    const short16 below_right = convert_short16(vload16(0, below + 1)) & in_right;
    const short16 above_left = convert_short16(vload16(0, above - RADIUS)) & in_left;
    const short16 above_right = convert_short16(vload16(0, above + 1)) & in_right;
    left_sum += below_left + above_left;
    right_sum += below_right + above_right;
    left_weighted += (below_left - above_left) * (short16)((short)dy);
    right_weighted += (below_right - above_right) * (short16)((short)dy);
  }
  const int m10 = sum_of(convert_int16(left_sum) * convert_int16(left_x) +
                         convert_int16(right_sum) * convert_int16(right_x));
  const int m01 = sum_of(convert_int16(left_weighted) + convert_int16(right_weighted));
  for (int b = 1; b < BINS; ++b) {
    if (in_bin(b, m10, m01)) return b;
  }
  return 0;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void describe(
    __global const uchar* restrict image0, __global const uchar* restrict image1,
    __global const uchar* restrict blurred0, __global const uchar* restrict blurred1,
    __global int4* restrict keypoints, __global uint* restrict descriptors,
    __constant ushort2* restrict table, int width, int count) {
  uchar patch[PATCH_ROWS * PATCH_STRIDE];
  const int first = (int)get_global_id(0) * PER_ITEM;
  const int last = min(first + PER_ITEM, count);
  for (int index = first; index < last; ++index) {
    int4 keypoint = keypoints[index];
    const int level = level_of(keypoint);
    const int stride = level == 0 ? width : width * 5 / 6;
    const int centre = (keypoint.z >> 16) * stride + (keypoint.z & 0xFFFF);
    const int bin = direction_bin((level == 0 ? image0 : image1) + centre, stride);
    __global const uchar* soft =
        (level == 0 ? blurred0 : blurred1) + centre - RADIUS * stride - RADIUS;
    for (int row = 0; row < PATCH_ROWS; ++row) {
      vstore16(vload16(0, soft + row * stride), 0, patch + row * PATCH_STRIDE);
      vstore16(vload16(1, soft + row * stride), 1, patch + row * PATCH_STRIDE);
    }
    __constant ushort2* tests = table + bin * TESTS;
    for (int word = 0; word < 8; ++word) {
      uint bits = 0;
#pragma unroll  // else vectors are gathered byte by byte, which is slower than this
      for (int t = 0; t < 32; ++t) {
        const ushort2 pair = tests[word * 32 + t];
        bits |= (patch[pair.x] < patch[pair.y] ? 1u : 0u) << t;
      }
      descriptors[index * 8 + word] = bits;
    }
    keypoint.w = (keypoint.w & ~0xFF00) | (bin << 8);
    keypoints[index] = keypoint;
  }
}
