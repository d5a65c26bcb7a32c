// Disparities of the support grid, CPU variant.
// Assumes: 16-byte descriptors, row-major; pictures at least 2 MARGIN wide; max_disparity <= 255.
// One work-item takes one row of the grid, local size 1. Sixteen disparities are compared at once,
// four and four side by side in memory; disparities beyond the picture are computed on columns that
// are inside, and left out of the choice. The way back is only gone from distinct matches.
#include "depth/constants.clh"
#include "depth/distance.clh"

#define NEVER 0xffffffffu

// One view's rows two above and two below the grid's, its row in the middle, and where disparities
// lead in the other view.
typedef struct {
  __global const uchar* restrict own;
  __global const uchar* restrict other;
  int direction;
  int width;
  int v;
} View;

static inline __global const uchar* row_at(__global const uchar* view, int width, int v) {
  return view + (size_t)v * (size_t)width * 16;
}

static inline ulong8 four_times(__global const uchar* descriptor) {
  const ulong2 d = vload2(0, (__global const ulong*)descriptor);
  return d.s01010101;
}

static inline uint least_of(uint16 keys) {
  const uint8 eight = min(keys.lo, keys.hi);
  const uint4 four = min(eight.lo, eight.hi);
  const uint2 two = min(four.lo, four.hi);
  return min(two.x, two.y);
}

// Halves of the costs of four disparities, at columns `column` .. `column` + 3 of the other view.
static inline ulong8 half_costs(ulong8 a, ulong8 b, ulong8 c, ulong8 d, __global const uchar* above,
                                __global const uchar* below, int column) {
  __global const ulong* p = (__global const ulong*)(above + (column - 2) * 16);
  __global const ulong* q = (__global const ulong*)(below + (column - 2) * 16);
  return sad4(a, vload8(0, p)) + sad4(b, vload8(1, p)) + sad4(c, vload8(0, q)) +
         sad4(d, vload8(1, q));
}

// The best disparity; `distinct` tells whether it passes the texture and ratio tests.
static inline int match(const View view, int u, int max_disparity, int texture, int ratio,
                        int* distinct) {
  __global const uchar* above = row_at(view.own, view.width, view.v - 2);
  __global const uchar* below = row_at(view.own, view.width, view.v + 2);
  const ulong8 a = four_times(above + (u - 2) * 16);
  const ulong8 b = four_times(above + (u + 2) * 16);
  const ulong8 c = four_times(below + (u - 2) * 16);
  const ulong8 d = four_times(below + (u + 2) * 16);
  __global const uchar* other_above = row_at(view.other, view.width, view.v - 2);
  __global const uchar* other_below = row_at(view.other, view.width, view.v + 2);
  const int room = view.direction < 0 ? u - MARGIN : view.width - 1 - MARGIN - u;
  const int last = min(max_disparity, room);

  // Keys order by cost, then by disparity. In memory the columns of four disparities ascend: so do
  // the disparities to the right, or they descend.
  uint16 keys[DISPARITIES / 16];
  const uint16 order = view.direction < 0
                           ? (uint16)(3, 7, 11, 15, 2, 6, 10, 14, 1, 5, 9, 13, 0, 4, 8, 12)
                           : (uint16)(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
  const int groups = last / 16 + 1;
  uint16 least = (uint16)(NEVER);
  for (int g = 0; g < groups; ++g) {
    const int nearest = view.direction < 0 ? u - 16 * g - 3 : u + 16 * g;
    const int4 wanted = (int4)(nearest) + (int4)(0, 4, 8, 12) * (int4)(view.direction);
    const int4 column = clamp(wanted, (int4)(2), (int4)(view.width - 6));
    const uint16 costs = totals(half_costs(a, b, c, d, other_above, other_below, column.s0),
                                half_costs(a, b, c, d, other_above, other_below, column.s1),
                                half_costs(a, b, c, d, other_above, other_below, column.s2),
                                half_costs(a, b, c, d, other_above, other_below, column.s3));
    const uint16 disparity = (uint16)((uint)(16 * g)) + order;
    const uint16 beyond = as_uint16(disparity > (uint16)((uint)last));
    keys[g] = (costs << (uint16)(8)) | disparity | beyond;
    least = min(least, keys[g]);
  }
  const uint best = least_of(least);
  const int disparity = (int)(best & 255u);

  const uint16 taken = (uint16)((uint)disparity);
  least = (uint16)(NEVER);
  for (int g = 0; g < groups; ++g) {
    // disparity - 1 .. disparity + 1 do not count.
    const uint16 off = (keys[g] & (uint16)(255u)) + (uint16)(1) - taken;
    least = min(least, keys[g] | as_uint16(off <= (uint16)(2)));
  }
  const uint second = least_of(least);

  const uchar16 here = vload16((size_t)view.v * (size_t)view.width + (size_t)u, view.own);
  *distinct = texture16(here) >= texture && second != NEVER &&
              100u * (best >> 8) < (uint)ratio * (second >> 8);
  return disparity;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void support_match(
    __global const uchar* restrict left, __global const uchar* restrict right,
    __global short* restrict grid, int width, int height, int step, int max_disparity, int texture,
    int ratio, int lr_threshold) {
  const int row = (int)get_global_id(0);
  const int v = row * step;
  const int columns = (width + step - 1) / step;
  const View left_view = {left, right, -1, width, v};
  const View right_view = {right, left, 1, width, v};
  for (int i = 0; i < columns; ++i) {
    const int u = i * step;
    short found = -1;
    if (v >= MARGIN && v < height - MARGIN && u >= MARGIN && u < width - MARGIN) {
      int distinct = 0;
      const int d = match(left_view, u, max_disparity, texture, ratio, &distinct);
      if (distinct != 0) {
        const int back = match(right_view, u - d, max_disparity, texture, ratio, &distinct);
        if (distinct != 0 && max(d, back) - min(d, back) <= lr_threshold) found = (short)d;
      }
    }
    grid[(size_t)row * (size_t)columns + (size_t)i] = found;
  }
}
