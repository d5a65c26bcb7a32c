// Dense maximum a-posteriori matching and the left-right check, CPU variant.
// Assumes: 16-byte descriptors, row-major, any width from 4; max_disparity <= 255; an ascending
// list of disparities per cell. One work-item takes one row of cells (one band of rows in the
// check), local size 1. Four pixels side by side make a unit, whose descriptors are one vector;
// four units of a cell, from one row or from several, are a block that is matched at once. What
// would leave the row is done pixel by pixel.
#include "depth/constants.clh"
#include "depth/distance.clh"
#include "depth/refine.clh"

// Keys order by energy, then by disparity; descriptor distances enter at bit 8 + ENERGY_SHIFT.
#define KEY_SHIFT (8 + ENERGY_SHIFT)
#define NEVER 0xffffffffu
#define GROUPS (MAX_RADIUS / 2)  // of four candidates around a plane

typedef struct {
  __global const uchar* restrict own;    // descriptors of this view
  __global const uchar* restrict other;  // and of the other one
  __global const short* restrict map;
  __global const uchar* restrict list;  // the cell's
  __global const ushort* restrict prior;
  __private const uint16* penalties;
  int count;  // of the list
  int width;
  int direction;  // -1: a disparity leads to the left, +1: to the right
  int max_disparity;
  int radius;
  int texture;
} Task;

ALWAYS_INLINE ulong8 four(__global const uchar* descriptors, int at) {
  return vload8(0, (__global const ulong*)(descriptors + (size_t)at * 16));
}

static inline int distance_at(const Task t, int row, int x, int d) {
  const uchar16 mine = vload16((size_t)(row + x), t.own);
  return distance16(mine, vload16((size_t)(row + x + t.direction * d), t.other));
}

static inline bool possible(const Task t, int x, int d) {
  const int column = x + t.direction * d;
  return d >= 0 && d <= t.max_disparity && column >= 0 && column < t.width;
}

// ---- Pixel by pixel ----

static inline uint candidate(const Task t, int row, int x, int d, uint penalty) {
  if (!possible(t, x, d)) return NEVER;
  return ((uint)distance_at(t, row, x, d) << KEY_SHIFT) + (penalty << 8) + (uint)d;
}

static inline uint listed_pixel(const Task t, int row, int x) {
  const uint away = t.prior[(t.radius << PLANE_BITS) + 1];
  uint best = NEVER;
  for (int n = 0; n < t.count; ++n) best = min(best, candidate(t, row, x, t.list[n], away));
  return best;
}

static inline uint plane_pixel(const Task t, int row, int x) {
  const int mu = t.map[row + x];
  const int floor = mu >> PLANE_BITS;
  uint best = NEVER;
  if (mu == NO_PLANE) return best;
  for (int d = floor - t.radius + 1; d <= floor + t.radius; ++d) {
    const int off = (d << PLANE_BITS) - mu;
    best = min(best, candidate(t, row, x, d, t.prior[max(off, -off)]));
  }
  return best;
}

static inline ushort decide_pixel(const Task t, int row, int x, uint key) {
  const int contrast = texture16(vload16((size_t)(row + x), t.own));
  if (key == NEVER || contrast < t.texture) return 0;
  const int d = (int)(key & 255u);
  int offset = 0;
  if (t.direction < 0 && possible(t, x, d - 1) && possible(t, x, d + 1)) {
    offset = refinement(distance_at(t, row, x, d - 1), distance_at(t, row, x, d),
                        distance_at(t, row, x, d + 1));
  }
  return stored(d, offset);
}

// ---- Block by block: unit k begins at place `at[k]` of the picture, in a row that begins at
// `row[k]` ----

// Best of the list, of pixel p of unit k at place 4 k + p. All disparities stay inside.
ALWAYS_INLINE uint16 listed_block(const Task t, int4 at) {
  const ulong8 a = four(t.own, at.s0);
  const ulong8 b = four(t.own, at.s1);
  const ulong8 c = four(t.own, at.s2);
  const ulong8 e = four(t.own, at.s3);
  const uint away = (uint)t.prior[(t.radius << PLANE_BITS) + 1] << 8;
  uint16 best = (uint16)(NEVER);
  for (int n = 0; n < t.count; ++n) {
    const int d = t.list[n];
    const int shift = t.direction * d;
    const uint16 distances =
        totals(sad4(a, four(t.other, at.s0 + shift)), sad4(b, four(t.other, at.s1 + shift)),
               sad4(c, four(t.other, at.s2 + shift)), sad4(e, four(t.other, at.s3 + shift)));
    best = min(best, (distances << (uint16)(KEY_SHIFT)) + (uint16)(away + (uint)d));
  }
  return transposed(best);
}

ALWAYS_INLINE uint16 contrast_block(const Task t, int4 at) {
  const ulong8 grey = (ulong8)(0x8080808080808080ul);
  return transposed(totals(sad4(four(t.own, at.s0), grey), sad4(four(t.own, at.s1), grey),
                           sad4(four(t.own, at.s2), grey), sad4(four(t.own, at.s3), grey)));
}

ALWAYS_INLINE ulong8 four_times(__global const uchar* descriptors, int at) {
  const ulong2 d = vload2((size_t)at, (__global const ulong*)descriptors);
  return d.s01010101;
}

// Lane c of the result is row c of the first, second, third, last where p is 0, 1, 2, 3.
ALWAYS_INLINE uint16 mixed(uint16 a, uint16 b, uint16 c, uint16 d) {
  const uint16 ab = select(a, b, (uint16)(0, ~0u, 0, 0, 0, ~0u, 0, 0, 0, ~0u, 0, 0, 0, ~0u, 0, 0));
  const uint16 cd = select(c, d, (uint16)(0, 0, 0, ~0u, 0, 0, 0, ~0u, 0, 0, 0, ~0u, 0, 0, 0, ~0u));
  return select(ab, cd, (uint16)(0, 0, ~0u, ~0u, 0, 0, ~0u, ~0u, 0, 0, ~0u, ~0u, 0, 0, ~0u, ~0u));
}

// Best candidates of the planes of the four pixels from `at`, in the row that begins at `row`.
ALWAYS_INLINE uint4 plane_unit(const Task t, int at, int row) {
  const int4 mu = convert_int4(vload4(0, t.map + at));
  const int4 floor = mu >> (int4)(PLANE_BITS);
  const int groups = (t.radius + 1) / 2;
  const int x = at - row;
  // In memory the candidates' columns ascend: so does the disparity to the right, or it descends.
  const int4 column = (int4)(x) + (int4)(0, 1, 2, 3);
  const int4 first =
      t.direction < 0 ? column - floor - (int4)(t.radius) : column + floor - (int4)(t.radius - 1);
  const int4 inside = (mu != (int4)(NO_PLANE)) & (floor >= (int4)(t.radius - 1)) &
                      (floor <= (int4)(t.max_disparity - t.radius)) & (first >= (int4)(0)) &
                      (first <= (int4)(t.width - 4 * groups));
  if (all(inside) == 0) {
    if (any(mu != (int4)(NO_PLANE)) == 0) return (uint4)(NEVER);
    uint keys[4];
    for (int p = 0; p < 4; ++p) keys[p] = plane_pixel(t, row, x + p);
    return vload4(0, keys);
  }
  const ulong8 a = four_times(t.own, at);
  const ulong8 b = four_times(t.own, at + 1);
  const ulong8 c = four_times(t.own, at + 2);
  const ulong8 e = four_times(t.own, at + 3);
  const int4 fraction = mu & (int4)((1 << PLANE_BITS) - 1);
  uint16 best = (uint16)(NEVER);
  for (int g = 0; g < groups; ++g) {
    const int4 from = first + (int4)(row + 4 * g);
    const uint16 distances =
        totals(sad4(a, four(t.other, from.s0)), sad4(b, four(t.other, from.s1)),
               sad4(c, four(t.other, from.s2)), sad4(e, four(t.other, from.s3)));
    __private const uint16* table = t.penalties + (g << PLANE_BITS);
    const uint16 penalty =
        mixed(table[fraction.s0], table[fraction.s1], table[fraction.s2], table[fraction.s3]);
    best = min(best, (distances << (uint16)(KEY_SHIFT)) + penalty);
  }
  return least_of_four(best) + as_uint4(floor);
}

// The parabola's offsets for the disparities `d` of the four pixels from `at`.
ALWAYS_INLINE int4 refine_unit(const Task t, int at, int row, int4 d) {
  const int4 from = (int4)(at - row) + (int4)(0, 1, 2, 3) - d - (int4)(1);
  const int4 sound = (d >= (int4)(1)) & (d < (int4)(t.max_disparity)) & (from >= (int4)(0)) &
                     (from < (int4)(t.width - 2));
  const int4 near = clamp(from, (int4)(0), (int4)(t.width - 4));
  if (any(sound & (near != from)) != 0) {
    int offsets[4];
    for (int p = 0; p < 4; ++p) {
      const int x = at - row + p;
      const int whole = p == 0 ? d.s0 : p == 1 ? d.s1 : p == 2 ? d.s2 : d.s3;
      offsets[p] =
          whole < 0 || !possible(t, x, whole - 1) || !possible(t, x, whole + 1)
              ? 0
              : refinement(distance_at(t, row, x, whole - 1), distance_at(t, row, x, whole),
                           distance_at(t, row, x, whole + 1));
    }
    return vload4(0, offsets);
  }
  const int4 start = near + (int4)(row);
  const uint16 distances = totals(sad4(four_times(t.own, at), four(t.other, start.s0)),
                                  sad4(four_times(t.own, at + 1), four(t.other, start.s1)),
                                  sad4(four_times(t.own, at + 2), four(t.other, start.s2)),
                                  sad4(four_times(t.own, at + 3), four(t.other, start.s3)));
  const int16 c = as_int16(distances);  // at d + 1, d, d - 1 of the four pixels, and one more
  const int4 behind = c.lo.lo;
  const int4 here = c.lo.hi;
  const int4 before = c.hi.lo;
  const int4 curvature = before + behind - (here << (int4)(1));
  const int4 good = sound & (before >= here) & (behind >= here) & (curvature > (int4)(0));
  const int4 divisor = select((int4)(1), curvature, good);
  const int4 numerator = select((int4)(0), (before - behind) << (int4)(7), good);
  // Both are exact as floats, so that the quotient is off by less than one.
  int4 quotient = convert_int4(convert_float4(numerator) / convert_float4(divisor));
  quotient += (quotient * divisor > numerator);
  return quotient - ((quotient + (int4)(1)) * divisor <= numerator);
}

ALWAYS_INLINE void store_unit(const Task t, int at, int row, uint4 key, uint4 contrast,
                              __global ushort* out) {
  const int4 none = (key == (uint4)(NEVER)) | (contrast < (uint4)((uint)t.texture));
  const int4 d = as_int4(key & (uint4)(255u)) | none;
  int4 value = d << (int4)(8);
  if (t.direction < 0) value += refine_unit(t, at, row, d);
  vstore4(convert_ushort4(select(max(value, (int4)(1)), (int4)(0), none)), 0, out + at);
}

// `edge`: some disparities of the list leave the row.
ALWAYS_INLINE void block(const Task t, int4 at, int4 row, bool edge, __global ushort* out) {
  int ats[4], rows[4];
  vstore4(at, 0, ats);
  vstore4(row, 0, rows);
  uint keys[16];
  uint contrasts[16];
  if (edge) {
    for (int k = 0; k < 16; ++k) {
      keys[k] = listed_pixel(t, rows[k / 4], ats[k / 4] - rows[k / 4] + k % 4);
    }
  } else {
    vstore16(listed_block(t, at), 0, keys);
  }
  vstore16(contrast_block(t, at), 0, contrasts);
  for (size_t k = 0; k < 4; ++k) {
    const uint4 key = min(vload4(k, keys), plane_unit(t, ats[k], rows[k]));
    store_unit(t, ats[k], rows[k], key, vload4(k, contrasts), out);
  }
}

// Columns [begin, end) of rows [top, bottom), all of one cell.
ALWAYS_INLINE void match_cell(const Task t, int begin, int end, int top, int bottom,
                              __global ushort* out) {
  const int across = (end - begin) / 4;
  const int units = across * (bottom - top);
  const int farthest = t.count > 0 ? t.list[t.count - 1] : 0;
  const bool edge = t.direction < 0 ? begin < farthest : end + farthest > t.width;
  for (int u = 0; u < units; u += 4) {
    // The last units are done twice rather than less than four at once.
    const int4 number = min((int4)(u) + (int4)(0, 1, 2, 3), (int4)(units - 1));
    const int4 down = number / (int4)(across);
    const int4 row = ((int4)(top) + down) * (int4)(t.width);
    block(t, row + (int4)(begin) + (number - down * (int4)(across)) * (int4)(4), row, edge, out);
  }
  for (int y = top; y < bottom; ++y) {
    const int row = y * t.width;
    for (int x = begin + 4 * across; x < end; ++x) {
      out[row + x] = decide_pixel(t, row, x, min(listed_pixel(t, row, x), plane_pixel(t, row, x)));
    }
  }
}

// Penalty and offset from the plane's floor of each candidate, for each fraction of the plane's
// disparity, in the candidates' order in memory, four times each.
static inline void make_penalties(__global const ushort* prior, int radius, int direction,
                                  __private uint16* penalties) {
  for (int g = 0; g < (radius + 1) / 2; ++g) {
    for (int f = 0; f < 1 << PLANE_BITS; ++f) {
      uint entries[4];
      for (int k = 0; k < 4; ++k) {
        const int c = 4 * g + k;
        const int offset = direction < 0 ? radius - c : c - radius + 1;
        const int off = (offset << PLANE_BITS) - f;
        // Behind the last candidate: beyond every energy, and no carry when the floor is added.
        entries[k] = c < 2 * radius ? ((uint)prior[max(off, -off)] << 8) + (uint)offset : 1u << 30;
      }
      penalties[(g << PLANE_BITS) + f] = (uint16)((uint4)(entries[0]), (uint4)(entries[1]),
                                                  (uint4)(entries[2]), (uint4)(entries[3]));
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void dense_match(
    __global const uchar* restrict own, __global const uchar* restrict other,
    __global const short* restrict map, __global const ushort* restrict counts,
    __global const uchar* restrict lists, __global const ushort* restrict prior,
    __global ushort* restrict disparities, int width, int height, int cell, int max_disparity,
    int radius, int right, int texture) {
  const int cy = (int)get_global_id(0);
  const int columns = (width + cell - 1) / cell;
  uint16 penalties[GROUPS << PLANE_BITS];
  Task t = {own,           other,  map,    lists, prior, penalties, 0, width, right != 0 ? 1 : -1,
            max_disparity, radius, texture};
  make_penalties(prior, radius, t.direction, penalties);
  const int bottom = min((cy + 1) * cell, height);
  for (int cx = 0; cx < columns; ++cx) {
    const size_t at = (size_t)(cy * columns + cx);
    t.list = lists + at * (size_t)(max_disparity + 1);
    t.count = counts[at];
    match_cell(t, cx * cell, min((cx + 1) * cell, width), cy * cell, bottom, disparities);
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void consistency(
    __global const ushort* restrict left, __global const ushort* restrict right,
    __global ushort* restrict out, int width, int height, int lr_threshold) {
  const int begin = (int)get_global_id(0) * BAND;
  for (int y = begin; y < min(begin + BAND, height); ++y) {
    const size_t row = (size_t)y * (size_t)width;
    for (int x = 0; x < width; ++x) {
      const int d = left[row + (size_t)x];
      const int column = x - ((d + 254) >> 8);
      const int back = right[row + (size_t)max(column, 0)];
      const bool good =
          d > 0 && column >= 0 && back > 0 && max(d, back) - min(d, back) <= lr_threshold * 256;
      out[row + (size_t)x] = (ushort)(good ? d : 0);
    }
  }
}
