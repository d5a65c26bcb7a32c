// Refines every unique match (see the GPU's text for how).
// Assumes: as there.
// One work-item per 16 queries. A row of the patch is a vector whose last five lanes are masked
// out; the eleven rows' differences add up in 16 bits: 121 * 255 < 2^15.
#include "frontend/refine.clh"

#define PER_ITEM 16

static inline int sum_of(ushort16 v) {
  const ushort8 a = v.lo + v.hi;
  const ushort4 b = a.lo + a.hi;
  const ushort2 c = b.lo + b.hi;
  return c.x + c.y;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void refine_sad(
    __global const uchar* restrict a0, __global const uchar* restrict a1,
    __global const uchar* restrict b0, __global const uchar* restrict b1,
    __global const int4* restrict keypoints_a, __global const int4* restrict keypoints_b,
    __global const int2* restrict matches, __global const int2* restrict inverse,
    __global int4* restrict refined_matches, int width, int count, int range_x, int range_y,
    int same_row, int max_sad) {
  int costs[MAX_POSITIONS];
  uchar16 patch[SAD_SIZE];
  const uchar16 mask =
      (uchar16)(255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 0, 0);
  const int across = 2 * range_x + 1;
  const int positions = across * (2 * range_y + 1);
  const int first = (int)get_global_id(0) * PER_ITEM;
  const int last = min(first + PER_ITEM, count);
  for (int index = first; index < last; ++index) {
    const int other = partner(matches, inverse, index);
    if (other < 0) {
      refined_matches[index] = REFUSED;
      continue;
    }
    const int4 a = keypoints_a[index];
    const int4 b = keypoints_b[other];
    const int level = level_of(a);
    const int stride = level == 0 ? width : width * 5 / 6;
    const int x = b.z & 0xFFFF;
    const int y = same_row ? a.z >> 16 : b.z >> 16;
    __global const uchar* from_a = (level == 0 ? a0 : a1) + ((a.z >> 16) - SAD_RADIUS) * stride +
                                   (a.z & 0xFFFF) - SAD_RADIUS;
    __global const uchar* from_b =
        (level == 0 ? b0 : b1) + (y - SAD_RADIUS - range_y) * stride + x - SAD_RADIUS - range_x;
    for (int row = 0; row < SAD_SIZE; ++row) patch[row] = vload16(0, from_a + row * stride) & mask;
    int p = 0;
    int best = 0;
    int best_x = 0;
    int best_y = 0;
    for (int dy = -range_y; dy <= range_y; ++dy) {
      for (int dx = -range_x; dx <= range_x; ++dx, ++p) {
        __global const uchar* at = from_b + (dy + range_y) * stride + dx + range_x;
        ushort16 sums = (ushort16)(0);
        for (int row = 0; row < SAD_SIZE; ++row) {
          const uchar16 there = vload16(0, at + row * stride) & mask;
          sums += convert_ushort16(max(patch[row], there) - min(patch[row], there));
        }
        costs[p] = sum_of(sums);
        if (p == 0 || costs[p] < costs[best]) {
          best = p;
          best_x = dx;
          best_y = dy;
        }
      }
    }
    const int west = best > 0 ? costs[best - 1] : 0;
    const int east = best + 1 < positions ? costs[best + 1] : 0;
    const int north = best >= across ? costs[best - across] : 0;
    const int south = best + across < positions ? costs[best + across] : 0;
    refined_matches[index] =
        refined(x, y, level, other, best_x, best_y, range_x, range_y, west, east, north, south,
                costs[best], max_sad);
  }
}
