// The best corners of every cell (see the GPU's text for what they are).
// Assumes: width, height > 2 BORDER, at most 4096; stride == width; cell even, at least 2.
// One work-item per row of cells. Sixteen pixels at a time, as most have no score at all; survivors
// are inserted into their cell's keys, which are written out at the end.
#include "frontend/common.clh"

#define MAX_COLUMNS 2048

static inline int any_set(uchar16 v) {
  const ulong2 words = as_ulong2(v);
  return (words.x | words.y) != 0;
}

static inline void insert(__private uint* keys, uint key) {
  for (int i = 0; i < PER_CELL && key != 0; ++i) {
    const uint old = keys[i];
    keys[i] = max(old, key);
    key = min(old, key);
  }
}

static inline uchar survives(__global const uchar* p, int width) {
  const uchar s = p[0];
  __global const uchar* above = p - width;
  __global const uchar* below = p + width;
  const uchar before = max(max(above[-1], above[0]), max(above[1], p[-1]));
  const uchar after = max(max(below[-1], below[0]), max(below[1], p[1]));
  return s > before && s >= after ? s : (uchar)0;
}

static inline uchar16 survivors(__global const uchar* p, int width, uchar16 s) {
  __global const uchar* above = p - width;
  __global const uchar* below = p + width;
  const uchar16 before = max(max(vload16(0, above - 1), vload16(0, above)),
                             max(vload16(0, above + 1), vload16(0, p - 1)));
  const uchar16 after = max(max(vload16(0, below - 1), vload16(0, below)),
                            max(vload16(0, below + 1), vload16(0, p + 1)));
  return select((uchar16)(0), s, (s > before) & (s >= after));
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void select_cells(
    __global const uchar* restrict score, __global uint* restrict slots, int width, int height,
    int cell, int first_cell, int threshold_high) {
  const int columns = (width - 2 * BORDER + cell - 1) / cell;
  const int grid_row = (int)get_global_id(0);
  uint keys[MAX_COLUMNS * PER_CELL];
  for (int i = 0; i < columns * PER_CELL; ++i) keys[i] = 0;

  const int right = width - BORDER;
  const int top = BORDER + grid_row * cell;
  const int bottom = min(top + cell, height - BORDER);
  for (int y = top; y < bottom; ++y) {
    __global const uchar* row = score + y * width;
    int x = BORDER;
    for (; x + 16 <= right; x += 16) {
      uchar16 s = vload16(0, row + x);
      if (!any_set(s)) continue;
      s = survivors(row + x, width, s);
      if (!any_set(s)) continue;
      uchar lanes[16];
      vstore16(s, 0, lanes);
      for (int l = 0; l < 16; ++l) {
        if (lanes[l] != 0) {
          insert(keys + (x + l - BORDER) / cell * PER_CELL, corner_key(lanes[l], x + l, y));
        }
      }
    }
    for (; x < right; ++x) {
      const uchar s = row[x] != 0 ? survives(row + x, width) : (uchar)0;
      if (s != 0) insert(keys + (x - BORDER) / cell * PER_CELL, corner_key(s, x, y));
    }
  }

  const uint high = (uint)threshold_high;
  __global uint* row_slots = slots + (first_cell + grid_row * columns) * PER_CELL;
  for (int i = 0; i < columns; ++i) {
    __private const uint* of_cell = keys + i * PER_CELL;
    const int has_high = (of_cell[0] >> 24) > high;
    for (int k = 0; k < PER_CELL; ++k) {
      row_slots[i * PER_CELL + k] = has_high && (of_cell[k] >> 24) <= high ? 0u : of_cell[k];
    }
  }
}
