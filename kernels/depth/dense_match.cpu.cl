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
  __global const uchar* restrict own;    // descriptors of this row, this view
  __global const uchar* restrict other;  // and of the other view
  int width;
  int direction;  // -1: a disparity leads to the left, +1: to the right
  int max_disparity;
  ulong away;  // energy of a disparity that no plane supports, in place
} Row;

static inline ulong8 four(__global const uchar* descriptors, int x) {
  return vload8(0, (__global const ulong*)(descriptors + x * 16));
}

// A candidate's descriptor distance in a key's place; NEVER if it lies outside.
static inline ulong candidate(const Row row, uchar16 mine, int x, int d) {
  const int column = x + row.direction * d;
  const int inside = clamp(column, 0, row.width - 1);
  const int distance = distance16(mine, vload16((size_t)inside, row.other));
  const bool outside = d < 0 || d > row.max_disparity || column != inside;
  return outside ? NEVER : (ulong)distance << KEY_SHIFT;
}

// `addend`: penalty and disparity in their places.
static inline ulong with_penalty(ulong key, ulong addend) {
  return key == NEVER ? NEVER : key + addend;
}

// Best candidate of the plane `mu` for the pixel at x.
static inline ulong best_of_plane(const Row row, int x, int mu, __private const ulong* penalties) {
  if (mu == NO_PLANE) return NEVER;
  const int floor = mu >> PLANE_BITS;
  const ulong8 penalty = vload8((size_t)(mu & ((1 << PLANE_BITS) - 1)), penalties);
  // In memory the candidates' columns ascend: so does the disparity to the right, or it descends.
  const int first = row.direction < 0 ? x - floor - 2 : x + floor - 1;
  const ulong2 d = vload2((size_t)x, (__global const ulong*)row.own);
  if (floor >= 1 && floor + 2 <= row.max_disparity && first >= 0 && first + 3 < row.width) {
    const ulong8 distances = distance4(d.s01010101, four(row.other, first));
    const ulong8 keys = (distances << KEY_SHIFT) + (ulong8)((ulong)floor) + penalty;
    return least_of(keys);
  }
  const uchar16 mine = as_uchar16(d);
  const int step = row.direction;
  const int start = step < 0 ? floor + 2 : floor - 1;
  const ulong base = (ulong)floor;
  const ulong one = with_penalty(candidate(row, mine, x, start), base + penalty.s0);
  const ulong two = with_penalty(candidate(row, mine, x, start + step), base + penalty.s2);
  const ulong three = with_penalty(candidate(row, mine, x, start + 2 * step), base + penalty.s4);
  const ulong last = with_penalty(candidate(row, mine, x, start + 3 * step), base + penalty.s6);
  return min(min(one, two), min(three, last));
}

static inline ulong listed_pixel(const Row row, int x, __global const uchar* list, int count) {
  const uchar16 mine = vload16((size_t)x, row.own);
  ulong best = NEVER;
  for (int n = 0; n < count; ++n) {
    const int d = list[n];
    best = min(best, with_penalty(candidate(row, mine, x, d), row.away + (ulong)d));
  }
  return best;
}

// Four keys, each in two places.
static inline ulong8 twice(ulong a, ulong b, ulong c, ulong d) {
  return (ulong8)(a, a, b, b, c, c, d, d);
}

// The same for pixels x .. x + 3.
static inline ulong8 listed_four(const Row row, int x, __global const uchar* list, int count) {
  const ulong8 own = four(row.own, x);
  ulong8 best = (ulong8)(NEVER);
  for (int n = 0; n < count; ++n) {
    const int d = list[n];
    const int first = x + row.direction * d;
    if (first >= 0 && first + 3 < row.width) {
      const ulong8 distances = distance4(own, four(row.other, first));
      best = min(best, (distances << KEY_SHIFT) + (ulong8)(row.away + (ulong)d));
    } else {
      best =
          min(best,
              twice(listed_pixel(row, x, list + n, 1), listed_pixel(row, x + 1, list + n, 1),
                    listed_pixel(row, x + 2, list + n, 1), listed_pixel(row, x + 3, list + n, 1)));
    }
  }
  return best;
}

static inline short decide(const Row row, int x, ulong key, int texture) {
  const int contrast = texture16(vload16((size_t)x, row.own));
  return (short)(key == NEVER || contrast < texture ? -1 : (int)(key & 255ul));
}

static inline void cell_row(const Row row, int x, int end, __global const short* map,
                            __global const uchar* list, int count, __private const ulong* penalties,
                            int texture, __global short* out) {
  for (; x + 4 <= end; x += 4) {
    const ulong8 listed = listed_four(row, x, list, count);
    const ulong8 planes = twice(best_of_plane(row, x, map[x], penalties),
                                best_of_plane(row, x + 1, map[x + 1], penalties),
                                best_of_plane(row, x + 2, map[x + 2], penalties),
                                best_of_plane(row, x + 3, map[x + 3], penalties));
    const ulong8 best = min(listed, planes);
    const ulong8 contrast = distance4(four(row.own, x), (ulong8)(0x8080808080808080ul));
    const long8 rejected = (best == (ulong8)(NEVER)) | (contrast < (ulong8)((ulong)texture));
    const long8 chosen = as_long8(best & (ulong8)(255ul)) | rejected;
    out[x] = (short)chosen.s0;
    out[x + 1] = (short)chosen.s2;
    out[x + 2] = (short)chosen.s4;
    out[x + 3] = (short)chosen.s6;
  }
  for (; x < end; ++x) {
    const ulong best =
        min(listed_pixel(row, x, list, count), best_of_plane(row, x, map[x], penalties));
    out[x] = decide(row, x, best, texture);
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void dense_match(
    __global const uchar* restrict own, __global const uchar* restrict other,
    __global const short* restrict map, __global const ushort* restrict counts,
    __global const uchar* restrict lists, __global const ushort* restrict prior,
    __global short* restrict disparities, int width, int height, int max_disparity, int right,
    int texture) {
  const int cy = (int)get_global_id(0);
  const int columns = (width + CELL - 1) / CELL;
  const int direction = right != 0 ? 1 : -1;
  // Penalty and offset from the plane's floor, for each fraction of the plane's disparity, of the
  // four candidates as they lie in memory, each in both of its places.
  ulong penalties[8 << PLANE_BITS];
  for (int f = 0; f < 1 << PLANE_BITS; ++f) {
    for (int k = 0; k < 4; ++k) {
      const int offset = right != 0 ? k - 1 : 2 - k;
      const int off = (offset << PLANE_BITS) - f;
      const ulong penalty = ((ulong)prior[max(off, -off)] << 8) + (ulong)offset;
      penalties[8 * f + 2 * k] = penalty;
      penalties[8 * f + 2 * k + 1] = penalty;
    }
  }
  for (int y = cy * CELL; y < min((cy + 1) * CELL, height); ++y) {
    const size_t start = (size_t)y * (size_t)width;
    const Row row = {own + start * 16, other + start * 16, width,
                     direction,        max_disparity,      (ulong)prior[PRIOR_ENTRIES - 1] << 8};
    for (int cx = 0; cx < columns; ++cx) {
      const size_t cell = (size_t)(cy * columns + cx);
      cell_row(row, cx * CELL, min((cx + 1) * CELL, width), map + start,
               lists + cell * (size_t)(max_disparity + 1), counts[cell], penalties, texture,
               disparities + start);
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void consistency(
    __global const short* restrict left, __global const short* restrict right,
    __global ushort* restrict out, int width, int height, int lr_threshold) {
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
