// Disparities of the support grid, CPU variant.
// Assumes: 16-byte descriptors, row-major; pictures at least 2 MARGIN wide; max_disparity <= 255.
// One work-item takes one row of the grid, local size 1. Four disparities lie side by side in
// memory and are compared at once; disparities beyond the picture are computed on columns that are
// inside, and left out of the choice.
#include "depth/constants.clh"
#include "depth/distance.clh"

#define NEVER 0xfffffffffffffffful

// One view's rows two above and two below the grid's, its row in the middle, and where disparities
// lead in the other view.
typedef struct {
  __global const uchar* restrict own;
  __global const uchar* restrict other;
  int direction;
  int width;
  int v;
} View;

static inline ulong8 four_times(__global const uchar* descriptor) {
  const ulong2 d = vload2(0, (__global const ulong*)descriptor);
  return d.s01010101;
}

// The best disparity; `distinct` tells whether it passes the texture and ratio tests.
static inline int match(const View view, int u, int max_disparity, int texture, int ratio,
                        int* distinct) {
  __global const uchar* above = view.own + ((size_t)(view.v - 2) * (size_t)view.width) * 16;
  __global const uchar* below = view.own + ((size_t)(view.v + 2) * (size_t)view.width) * 16;
  const ulong8 a = four_times(above + (u - 2) * 16);
  const ulong8 b = four_times(above + (u + 2) * 16);
  const ulong8 c = four_times(below + (u - 2) * 16);
  const ulong8 d = four_times(below + (u + 2) * 16);
  __global const uchar* other_above = view.other + ((size_t)(view.v - 2) * (size_t)view.width) * 16;
  __global const uchar* other_below = view.other + ((size_t)(view.v + 2) * (size_t)view.width) * 16;
  const int room = view.direction < 0 ? u - MARGIN : view.width - 1 - MARGIN - u;
  const int last = min(max_disparity, room);

  // Keys order by cost, then by disparity; each lies in two places. In memory the columns of four
  // disparities ascend: so do the disparities to the right, or they descend.
  ulong8 keys[DISPARITIES / 4];
  const ulong8 order =
      view.direction < 0 ? (ulong8)(3, 3, 2, 2, 1, 1, 0, 0) : (ulong8)(0, 0, 1, 1, 2, 2, 3, 3);
  const int groups = (max_disparity + 4) / 4;
  ulong8 least = (ulong8)(NEVER);
  for (int k = 0; k < groups; ++k) {
    const int wanted = view.direction < 0 ? u - 4 * k - 3 : u + 4 * k;
    const int column = clamp(wanted, 2, view.width - 6);
    __global const ulong* p = (__global const ulong*)(other_above + (column - 2) * 16);
    __global const ulong* q = (__global const ulong*)(other_below + (column - 2) * 16);
    const ulong8 sums = sad4(a, vload8(0, p)) + sad4(b, vload8(1, p)) + sad4(c, vload8(0, q)) +
                        sad4(d, vload8(1, q));
    const ulong8 costs = sums + sums.s10325476;
    const ulong8 disparity = (ulong8)((ulong)(4 * k)) + order;
    const ulong8 beyond = as_ulong8(disparity > (ulong8)((ulong)last));
    keys[k] = (costs << 8) | disparity | beyond;
    least = min(least, keys[k]);
  }
  const ulong best = least_of(least);
  const int disparity = (int)(best & 255ul);

  const ulong8 taken = (ulong8)((ulong)disparity);
  least = (ulong8)(NEVER);
  for (int k = 0; k < groups; ++k) {
    // disparity - 1 .. disparity + 1 do not count.
    const ulong8 off = (keys[k] & (ulong8)(255ul)) + (ulong8)(1) - taken;
    least = min(least, keys[k] | as_ulong8(off <= (ulong8)(2)));
  }
  const ulong second = least_of(least);

  const uchar16 here = vload16((size_t)view.v * (size_t)view.width + (size_t)u, view.own);
  *distinct = texture16(here) >= texture && second != NEVER &&
              100ul * (best >> 8) <= (ulong)ratio * (second >> 8);
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
