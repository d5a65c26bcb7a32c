// The best corners of every cell (see the GPU's text for what they are).
// Assumes: width, height > 2 BORDER, at most 4096; stride == width; cell even, at least 2; a device
// of little-endian words.
// One work-item per row of cells. A row's survivors are found by a loop without a branch, of which
// the compiler makes full vectors; then they are picked from words of eight, most of which are
// zero, and inserted into their cell's keys, which are written out at the end.
#include "frontend/common.clh"

#define MAX_COLUMNS 2048

static inline void insert(__private uint* keys, uint key) {
  for (int i = 0; i < PER_CELL; ++i) {
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
  return ((s > before) & (s >= after)) ? s : (uchar)0;
}

static inline void survivors(__global const uchar* row, __private uchar* kept, int width,
                             int right) {
  for (int x = BORDER; x < right; ++x) kept[x] = survives(row + x, width);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void select_cells(
    __global const uchar* restrict score, __global uint* restrict slots, int width, int height,
    int cell, int first_cell, int threshold_high) {
  const int columns = (width - 2 * BORDER + cell - 1) / cell;
  const int grid_row = (int)get_global_id(0);
  uint keys[MAX_COLUMNS * PER_CELL];
  uchar kept[4096 + 16];
  for (int i = 0; i < columns * PER_CELL; ++i) keys[i] = 0;

  // Exact for all dividends below 4096.
  const ulong reciprocal = (((ulong)1 << 32) + (uint)cell - 1) / (uint)cell;
  const int right = width - BORDER;
  const int top = BORDER + grid_row * cell;
  const int bottom = min(top + cell, height - BORDER);
  for (int y = top; y < bottom; ++y) {
    __global const uchar* row = score + y * width;
    survivors(row, kept, width, right);
    vstore8((uchar8)(0), 0, kept + right);
    for (int x = BORDER; x < right; x += 8) {
      ulong word = as_ulong(vload8(0, kept + x));
      while (word != 0) {
        const int byte = (int)(63 - clz(word)) >> 3;
        const uint of_pixel = (uint)(word >> (8 * byte)) & 0xFFu;
        word ^= (ulong)of_pixel << (8 * byte);
        const int at = x + byte;
        const uint column = (uint)(((ulong)(uint)(at - BORDER) * reciprocal) >> 32);
        insert(keys + column * PER_CELL, corner_key(of_pixel, at, y));
      }
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
