// Disparities of the support grid, GPU variant.
// Assumes: 16-byte descriptors, row-major; pictures at least 2 MARGIN wide; max_disparity <= 255.
// One work-group of GROUP work-items takes one point of the grid: it stages the stretch of the
// other view's two rows that all disparities need in local memory (column by column: coalesced),
// and each work-item weighs every GROUP-th disparity. Columns beyond the picture are staged from
// inside it and left out of the choice.
#include "depth/constants.clh"
#include "depth/distance_scalar.clh"

#define GROUP 64
#define NEVER 0xffffffffu
#define STRETCH (DISPARITIES + 4)

typedef struct {
  __global const uchar* restrict own;
  __global const uchar* restrict other;
  int direction;
  int width;
  int v;
} View;

// The least of all work-items' keys; every work-item gets it.
ALWAYS_INLINE uint least_of_group(uint key, __local uint* keys) {
  const int lane = (int)get_local_id(0);
  keys[lane] = key;
  for (int step = GROUP / 2; step > 0; step /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (lane < step) keys[lane] = min(keys[lane], keys[lane + step]);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint least = keys[0];
  barrier(CLK_LOCAL_MEM_FENCE);
  return least;
}

// Stages columns base .. base + max_disparity + 4 of rows v - 2 and v + 2.
ALWAYS_INLINE void stage(const View view, int base, int max_disparity, __local uchar16* stretch) {
  const int count = max_disparity + 5;
  for (int i = (int)get_local_id(0); i < count; i += GROUP) {
    const int column = clamp(base + i, 0, view.width - 1);
    const size_t above = (size_t)(view.v - 2) * (size_t)view.width + (size_t)column;
    const size_t below = (size_t)(view.v + 2) * (size_t)view.width + (size_t)column;
    stretch[i] = vload16(above, view.other);
    stretch[STRETCH + i] = vload16(below, view.other);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

ALWAYS_INLINE int match(const View view, int u, int max_disparity, int texture, int ratio,
                        int* distinct, __local uchar16* stretch, __local uint* scratch) {
  const int base = view.direction < 0 ? u - max_disparity - 2 : u - 2;
  stage(view, base, max_disparity, stretch);
  const size_t above = (size_t)(view.v - 2) * (size_t)view.width + (size_t)u;
  const size_t below = (size_t)(view.v + 2) * (size_t)view.width + (size_t)u;
  const uchar16 a = vload16(above - 2, view.own);
  const uchar16 b = vload16(above + 2, view.own);
  const uchar16 c = vload16(below - 2, view.own);
  const uchar16 e = vload16(below + 2, view.own);
  const int room = view.direction < 0 ? u - MARGIN : view.width - 1 - MARGIN - u;
  const int last = min(max_disparity, room);

  uint keys[DISPARITIES / GROUP];
  uint mine = NEVER;
  for (int k = 0; k < DISPARITIES / GROUP; ++k) {
    const int d = k * GROUP + (int)get_local_id(0);
    keys[k] = NEVER;
    if (d > last) continue;
    const int at = view.direction < 0 ? max_disparity - d : d;
    const int cost = distance16(a, stretch[at]) + distance16(b, stretch[at + 4]) +
                     distance16(c, stretch[STRETCH + at]) +
                     distance16(e, stretch[STRETCH + at + 4]);
    keys[k] = ((uint)cost << 8) | (uint)d;
    mine = min(mine, keys[k]);
  }
  const uint best = least_of_group(mine, scratch);
  const int disparity = (int)(best & 255u);

  mine = NEVER;
  for (int k = 0; k < DISPARITIES / GROUP; ++k) {
    const int d = k * GROUP + (int)get_local_id(0);
    if (d < disparity - 1 || d > disparity + 1) mine = min(mine, keys[k]);
  }
  const uint second = least_of_group(mine, scratch);

  const uchar16 here = vload16((size_t)view.v * (size_t)view.width + (size_t)u, view.own);
  *distinct = texture16(here) >= texture && second != NEVER &&
              100u * (best >> 8) < (uint)ratio * (second >> 8);
  return disparity;
}

__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void support_match(
    __global const uchar* restrict left, __global const uchar* restrict right,
    __global short* restrict grid, int width, int height, int step, int max_disparity, int texture,
    int ratio, int lr_threshold) {
  __local uchar16 stretch[2 * STRETCH];
  __local uint scratch[GROUP];
  const int i = (int)get_group_id(0);
  const int row = (int)get_group_id(1);
  const int u = i * step;
  const int v = row * step;
  // Points at the border go through the motions at the nearest place inside and are dropped: no
  // barrier stands under a condition.
  const int inner_u = clamp(u, MARGIN, width - 1 - MARGIN);
  const int inner_v = clamp(v, MARGIN, height - 1 - MARGIN);
  const View left_view = {left, right, -1, width, inner_v};
  const View right_view = {right, left, 1, width, inner_v};
  int distinct = 0;
  int distinct_back = 0;
  const int d =
      match(left_view, inner_u, max_disparity, texture, ratio, &distinct, stretch, scratch);
  const int back = match(right_view, inner_u - d, max_disparity, texture, ratio, &distinct_back,
                         stretch, scratch);
  const bool good = u == inner_u && v == inner_v && distinct != 0 && distinct_back != 0 &&
                    max(d, back) - min(d, back) <= lr_threshold;
  if (get_local_id(0) == 0) {
    grid[(size_t)row * get_num_groups(0) + (size_t)i] = (short)(good ? d : -1);
  }
}
