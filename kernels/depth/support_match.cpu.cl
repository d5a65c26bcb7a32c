// Disparities of the support grid, CPU variant.
// Assumes: 16-byte descriptors, row-major; pictures at least 2 MARGIN wide; max_disparity <= 255.
// One work-item takes one row of the grid, local size 1. Four disparities lie side by side in
// memory and are compared at once; disparities beyond the picture are computed on columns that are
// inside, and left out of the choice.
#include "depth/constants.clh"
#include "depth/distance.clh"

#define NEVER 0xffffffffu

// One view's rows two above and two below the grid's, its row in the middle, and where disparities
// lead in the other view.
typedef struct {
  __global const uchar *restrict own;
  __global const uchar *restrict other;
  int direction;
  int width;
  int v;
} View;

static inline ulong8 four_times(__global const uchar *descriptor) {
  const ulong2 d = vload2(0, (__global const ulong *)descriptor);
  return (ulong8)(d, d, d, d);
}

// The best disparity; `distinct` tells whether it passes the texture and ratio tests.
static inline int match(const View view, int u, int max_disparity, int texture, int ratio,
                        int *distinct) {
  __global const uchar *above = view.own + ((size_t)(view.v - 2) * (size_t)view.width) * 16;
  __global const uchar *below = view.own + ((size_t)(view.v + 2) * (size_t)view.width) * 16;
  const ulong8 a = four_times(above + (u - 2) * 16);
  const ulong8 b = four_times(above + (u + 2) * 16);
  const ulong8 c = four_times(below + (u - 2) * 16);
  const ulong8 d = four_times(below + (u + 2) * 16);
  __global const uchar *other_above =
      view.other + ((size_t)(view.v - 2) * (size_t)view.width) * 16;
  __global const uchar *other_below =
      view.other + ((size_t)(view.v + 2) * (size_t)view.width) * 16;
  const int room = view.direction < 0 ? u - MARGIN : view.width - 1 - MARGIN - u;
  const int last = min(max_disparity, room);

  // Keys order by cost, then by disparity.
  uint keys[DISPARITIES + 16];
  for (int first = 0; first <= max_disparity; first += 4) {
    const int wanted = view.direction < 0 ? u - first - 3 : u + first;
    const int column = clamp(wanted, 2, view.width - 6);
    __global const ulong *p = (__global const ulong *)(other_above + (column - 2) * 16);
    __global const ulong *q = (__global const ulong *)(other_below + (column - 2) * 16);
    const ulong8 sums = sad4(a, vload8(0, p)) + sad4(b, vload8(1, p)) + sad4(c, vload8(0, q)) +
                        sad4(d, vload8(1, q));
    const uint4 costs = convert_uint4(sums.even + sums.odd);
    const uint4 ordered = view.direction < 0 ? costs.wzyx : costs;
    const uint4 disparity = (uint4)((uint)first) + (uint4)(0, 1, 2, 3);
    vstore4(((ordered << 8) | disparity) | as_uint4(as_int4(disparity) > (int4)(last)), 0,
            keys + first);
  }
  const int end = (max_disparity + 4) / 4 * 4;
  vstore16((uint16)(NEVER), 0, keys + end);

  uint16 least = (uint16)(NEVER);
  for (int k = 0; k < end; k += 16) least = min(least, vload16(0, keys + k));
  const uint8 eight = min(least.lo, least.hi);
  const uint4 four = min(eight.lo, eight.hi);
  const uint best = min(min(four.x, four.y), min(four.z, four.w));
  const int disparity = (int)(best & 255u);

  for (int k = max(disparity - 1, 0); k <= disparity + 1; ++k) keys[k] = NEVER;
  least = (uint16)(NEVER);
  for (int k = 0; k < end; k += 16) least = min(least, vload16(0, keys + k));
  const uint8 eight2 = min(least.lo, least.hi);
  const uint4 four2 = min(eight2.lo, eight2.hi);
  const uint second = min(min(four2.x, four2.y), min(four2.z, four2.w));

  const uchar16 here =
      vload16((size_t)view.v * (size_t)view.width + (size_t)u, view.own);
  *distinct = texture16(here) >= texture && second != NEVER &&
              100u * (best >> 8) <= (uint)ratio * (second >> 8);
  return disparity;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void support_match(
    __global const uchar *restrict left, __global const uchar *restrict right,
    __global short *restrict grid, int width, int height, int step, int max_disparity, int texture,
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
      int distinct_back = 0;
      const int d = match(left_view, u, max_disparity, texture, ratio, &distinct);
      const int back = match(right_view, u - d, max_disparity, texture, ratio, &distinct_back);
      if (distinct != 0 && distinct_back != 0 && max(d, back) - min(d, back) <= lr_threshold) {
        found = (short)d;
      }
    }
    grid[(size_t)row * (size_t)columns + (size_t)i] = found;
  }
}
