// Dense maximum a-posteriori matching and the left-right check, CPU variant.
// Assumes: 16-byte descriptors, row-major, any width; max_disparity <= 255; an ascending list of
// disparities per cell. One work-item takes one row of cells (one band of rows in the check), local
// size 1. Four pixels at a time are compared for a disparity of the cell's list, and the four
// disparities around a pixel's plane at once; where that would leave the row, one by one.
#include "depth/constants.clh"
#include "depth/distance.clh"

// Keys order by energy, then by disparity; descriptor distances enter at bit 8 + ENERGY_SHIFT.
#define KEY_SHIFT (8 + ENERGY_SHIFT)
#define NEVER 0xfffffffffffffffful

typedef struct {
  __global const uchar *restrict own;    // descriptors of this row, this view
  __global const uchar *restrict other;  // and of the other view
  int width;
  int direction;  // -1: a disparity leads to the left, +1: to the right
  int max_disparity;
  ulong away;  // energy of a disparity that no plane supports, in place
} Row;

static inline ulong8 four(__global const uchar *descriptors, int x) {
  return vload8(0, (__global const ulong *)(descriptors + x * 16));
}

// A candidate's descriptor distance in a key's place; NEVER if it lies outside.
static inline ulong candidate(const Row row, uchar16 mine, int x, int d) {
  const int column = x + row.direction * d;
  const int inside = clamp(column, 0, row.width - 1);
  const int distance = distance16(mine, vload16((size_t)inside, row.other));
  const bool outside = d < 0 || d > row.max_disparity || column != inside;
  return outside ? NEVER : (ulong)distance << KEY_SHIFT;
}

// Best candidate of the plane `mu` (not NO_PLANE) for the pixel at x.
static inline ulong plane_pixel(const Row row, int x, int mu, __private const ulong8 *penalties) {
  const int floor = mu >> PLANE_BITS;
  const ulong8 penalty = penalties[mu & ((1 << PLANE_BITS) - 1)];
  // In memory the candidates' columns ascend: so does the disparity to the right, or it descends.
  const int first = row.direction < 0 ? x - floor - 2 : x + floor - 1;
  const ulong2 d = vload2((size_t)x, (__global const ulong *)row.own);
  ulong4 keys;
  if (floor >= 1 && floor + 2 <= row.max_disparity && first >= 0 && first + 3 < row.width) {
    const ulong8 distances = distance4((ulong8)(d, d, d, d), four(row.other, first));
    keys = ((distances << KEY_SHIFT) + (ulong8)((ulong)floor) + penalty).even;
  } else {
    const uchar16 mine = as_uchar16(d);
    const int lowest = row.direction < 0 ? floor + 2 : floor - 1;
    keys = (ulong4)(candidate(row, mine, x, lowest),
                    candidate(row, mine, x, lowest + row.direction),
                    candidate(row, mine, x, lowest + 2 * row.direction),
                    candidate(row, mine, x, lowest + 3 * row.direction));
    const ulong4 outside = as_ulong4(keys == (ulong4)(NEVER));
    keys = (keys + (ulong4)((ulong)floor) + penalty.even) | outside;
  }
  const ulong2 two = min(keys.lo, keys.hi);
  return min(two.x, two.y);
}

static inline ulong listed_pixel(const Row row, int x, __global const uchar *list, int count) {
  const uchar16 mine = vload16((size_t)x, row.own);
  ulong best = NEVER;
  for (int n = 0; n < count; ++n) {
    const ulong key = candidate(row, mine, x, list[n]);
    best = min(best, key == NEVER ? NEVER : key + row.away + list[n]);
  }
  return best;
}

// The same for pixels x .. x + 3.
static inline ulong4 listed_four(const Row row, int x, __global const uchar *list, int count) {
  const ulong8 own = four(row.own, x);
  ulong8 best = (ulong8)(NEVER);
  ulong4 edge = (ulong4)(NEVER);
  for (int n = 0; n < count; ++n) {
    const int d = list[n];
    const int first = x + row.direction * d;
    if (first >= 0 && first + 3 < row.width) {
      const ulong8 distances = distance4(own, four(row.other, first));
      best = min(best, (distances << KEY_SHIFT) + (ulong8)(row.away + (ulong)d));
    } else {
      edge = min(edge, (ulong4)(listed_pixel(row, x, list + n, 1),
                                listed_pixel(row, x + 1, list + n, 1),
                                listed_pixel(row, x + 2, list + n, 1),
                                listed_pixel(row, x + 3, list + n, 1)));
    }
  }
  return min(best.even, edge);
}

static inline short decide(const Row row, int x, ulong key, int texture) {
  const int contrast = texture16(vload16((size_t)x, row.own));
  return (short)(key == NEVER || contrast < texture ? -1 : (int)(key & 255ul));
}

static inline void cell_row(const Row row, int x, int end, __global const short *map,
                            __global const uchar *list, int count,
                            __private const ulong8 *penalties, int texture, __global short *out) {
  for (; x + 4 <= end; x += 4) {
    const ulong4 keys = listed_four(row, x, list, count);
    const short4 mu = vload4(0, map + x);
    const ulong4 planes = (ulong4)(
        mu.x == NO_PLANE ? NEVER : plane_pixel(row, x, mu.x, penalties),
        mu.y == NO_PLANE ? NEVER : plane_pixel(row, x + 1, mu.y, penalties),
        mu.z == NO_PLANE ? NEVER : plane_pixel(row, x + 2, mu.z, penalties),
        mu.w == NO_PLANE ? NEVER : plane_pixel(row, x + 3, mu.w, penalties));
    const ulong4 best = min(keys, planes);
    const ulong4 contrast = distance4(four(row.own, x), (ulong8)(0x8080808080808080ul)).even;
    const long4 rejected = (best == (ulong4)(NEVER)) | (contrast < (ulong4)((ulong)texture));
    vstore4(convert_short4(as_long4(best & (ulong4)(255ul)) | rejected), 0, out + x);
  }
  for (; x < end; ++x) {
    ulong best = listed_pixel(row, x, list, count);
    if (map[x] != NO_PLANE) best = min(best, plane_pixel(row, x, map[x], penalties));
    out[x] = decide(row, x, best, texture);
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void dense_match(
    __global const uchar *restrict own, __global const uchar *restrict other,
    __global const short *restrict map, __global const ushort *restrict counts,
    __global const uchar *restrict lists, __global const ushort *restrict prior,
    __global short *restrict disparities, int width, int height, int max_disparity, int right,
    int texture) {
  const int cy = (int)get_global_id(0);
  const int columns = (width + CELL - 1) / CELL;
  const int direction = right != 0 ? 1 : -1;
  // Penalty and offset from the plane's floor, for each fraction of the plane's disparity, of the
  // four candidates as they lie in memory, each in both of its places.
  ulong8 penalties[1 << PLANE_BITS];
  for (int f = 0; f < 1 << PLANE_BITS; ++f) {
    const ulong up2 = ((ulong)prior[(2 << PLANE_BITS) - f] << 8) + 2;
    const ulong up1 = ((ulong)prior[(1 << PLANE_BITS) - f] << 8) + 1;
    const ulong at = (ulong)prior[f] << 8;
    const ulong down = ((ulong)prior[(1 << PLANE_BITS) + f] << 8) - 1;
    penalties[f] = right != 0 ? (ulong8)(down, down, at, at, up1, up1, up2, up2)
                              : (ulong8)(up2, up2, up1, up1, at, at, down, down);
  }
  for (int y = cy * CELL; y < min((cy + 1) * CELL, height); ++y) {
    const size_t start = (size_t)y * (size_t)width;
    const Row row = {own + start * 16, other + start * 16,    width,
                     direction,        max_disparity,         (ulong)prior[PRIOR_ENTRIES - 1] << 8};
    for (int cx = 0; cx < columns; ++cx) {
      const size_t cell = (size_t)(cy * columns + cx);
      cell_row(row, cx * CELL, min((cx + 1) * CELL, width), map + start,
               lists + cell * (size_t)(max_disparity + 1), counts[cell], penalties, texture,
               disparities + start);
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void consistency(
    __global const short *restrict left, __global const short *restrict right,
    __global ushort *restrict out, int width, int height, int lr_threshold) {
  const int begin = (int)get_global_id(0) * BAND;
  for (int y = begin; y < min(begin + BAND, height); ++y) {
    const size_t row = (size_t)y * (size_t)width;
    for (int x = 0; x < width; ++x) {
      const int d = left[row + (size_t)x];
      const int back = right[row + (size_t)clamp(x - d, 0, width - 1)];
      const bool good =
          d >= 0 && d <= x && back >= 0 && max(d, back) - min(d, back) <= lr_threshold;
      out[row + (size_t)x] = (ushort)(good ? max(d * 256, 1) : 0);
    }
  }
}
