// Dense maximum a-posteriori matching and the left-right check, GPU variant.
// Assumes: 16-byte descriptors, row-major; max_disparity <= 255; an ascending list of disparities
// per cell. Groups of 64 x 4 pixels, the NDRange rounded up to them; each stages the stretch of the
// other view's rows that its disparities can reach in local memory (20 KiB at most), coalesced,
// columns beyond the picture from inside it. Work-items of a cell read the same list.
#include "depth/constants.clh"
#include "depth/distance_scalar.clh"
#include "depth/refine.clh"

#define GROUP_X 64
#define GROUP_Y 4
#define STRETCH (GROUP_X + DISPARITIES - 1)
#define NEVER 0xffffffffu
#define PRIOR_ENTRIES ((MAX_RADIUS << PLANE_BITS) + 2)

// Keys order by energy, then by disparity.
static inline uint weigh(uchar16 mine, uchar16 theirs, int penalty, int d) {
  const int energy = (distance16(mine, theirs) << ENERGY_SHIFT) + penalty;
  return ((uint)energy << 8) | (uint)d;
}

__kernel __attribute__((reqd_work_group_size(GROUP_X, GROUP_Y, 1))) void dense_match(
    __global const uchar* restrict own, __global const uchar* restrict other,
    __global const short* restrict map, __global const ushort* restrict counts,
    __global const uchar* restrict lists, __global const ushort* restrict prior,
    __global ushort* restrict disparities, int width, int height, int cell, int max_disparity,
    int radius, int right, int texture) {
  __local uchar16 tile[STRETCH * GROUP_Y];
  __local ushort table[PRIOR_ENTRIES];
  const int lx = (int)get_local_id(0);
  const int ly = (int)get_local_id(1);
  const int x = (int)get_global_id(0);
  const int y = (int)get_global_id(1);
  const int base = (int)get_group_id(0) * GROUP_X - (right != 0 ? 0 : max_disparity);
  const size_t row = (size_t)min(y, height - 1) * (size_t)width;
  for (int i = lx; i < GROUP_X + max_disparity; i += GROUP_X) {
    const int column = clamp(base + i, 0, width - 1);
    tile[ly * STRETCH + i] = vload16(row + (size_t)column, other);
  }
  const int entries = (radius << PLANE_BITS) + 2;
  for (int i = ly * GROUP_X + lx; i < entries; i += GROUP_X * GROUP_Y) table[i] = prior[i];
  barrier(CLK_LOCAL_MEM_FENCE);
  if (x >= width || y >= height) return;

  const size_t here = row + (size_t)x;
  const uchar16 mine = vload16(here, own);
  const int room = min(max_disparity, right != 0 ? width - 1 - x : x);
  __local const uchar16* line = tile + ly * STRETCH + lx + (right != 0 ? 0 : max_disparity);
  const int direction = right != 0 ? 1 : -1;
  uint best = NEVER;
  const int mu = map[here];
  if (mu != NO_PLANE) {
    const int floor = mu >> PLANE_BITS;
    for (int d = max(floor - radius + 1, 0); d <= min(floor + radius, room); ++d) {
      const int off = (d << PLANE_BITS) - mu;
      best = min(best, weigh(mine, line[direction * d], table[max(off, -off)], d));
    }
  }
  const int at = (y / cell) * ((width + cell - 1) / cell) + x / cell;
  __global const uchar* list = lists + (size_t)at * (size_t)(max_disparity + 1);
  const int count = counts[at];
  const int away = table[entries - 1];
  for (int n = 0; n < count; ++n) {
    const int d = list[n];
    if (d <= room) best = min(best, weigh(mine, line[direction * d], away, d));
  }
  const bool none = best == NEVER || texture16(mine) < texture;
  const int d = (int)(best & 255u);
  int offset = 0;
  if (right == 0 && !none && d > 0 && d < room) {
    offset = refinement(distance16(mine, line[1 - d]), distance16(mine, line[-d]),
                        distance16(mine, line[-d - 1]));
  }
  disparities[here] = (ushort)(none ? 0 : stored(d, offset));
}

__kernel __attribute__((reqd_work_group_size(GROUP_X, GROUP_Y, 1))) void consistency(
    __global const ushort* restrict left, __global const ushort* restrict right,
    __global ushort* restrict out, int width, int height, int lr_threshold) {
  const int x = (int)get_global_id(0);
  const int y = (int)get_global_id(1);
  if (x >= width || y >= height) return;
  const size_t row = (size_t)y * (size_t)width;
  const int d = left[row + (size_t)x];
  const int column = x - ((d + 254) >> 8);
  const int back = right[row + (size_t)max(column, 0)];
  const bool good =
      d > 0 && column >= 0 && back > 0 && max(d, back) - min(d, back) <= lr_threshold * 256;
  out[row + (size_t)x] = (ushort)(good ? d : 0);
}
