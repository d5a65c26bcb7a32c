// The best corners of every cell (see the GPU's text for what they are).
// Assumes: 2 BORDER < width <= 4096, height > 2 BORDER; stride == width; cell even, at least 2.
// Streams the scores, two pixels per cycle, through two line buffers and a window of 3 x 4. Of two
// pixels side by side at most one survives the suppression, and as BORDER is odd and cells are
// even, the pair (odd, even) lies in one cell: one insertion into one cell's four keys per cycle.
// The keys of the current cell are in registers; they move to and from a memory at the cell's
// edges, where the next cell's entry is another address. The carried chain is one
// compare-and-select: II = 1.
#include "common/fpga.clh"
#include "frontend/common.clh"

#define MAX_WIDTH 4096
#define MAX_COLUMNS 2048

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void select_cells(
    __global const uchar* restrict score, __global uint* restrict slots, int width, int height,
    int cell, int first_cell, int threshold_high) {
  uchar lines[2][MAX_WIDTH + 4] PARTITION_COMPLETE(1) PARTITION_CYCLIC(2, 2);
  uchar window[3][4] PARTITION_COMPLETE(0);
  uint kept[MAX_COLUMNS][PER_CELL] PARTITION_COMPLETE(2);
  uint keys[PER_CELL] PARTITION_COMPLETE(0);
  for (int r = 0; r < 2; ++r) {
    for (int i = 0; i < width + 4; ++i) lines[r][i] = 0;
  }
  for (int r = 0; r < 3; ++r) {
    for (int i = 0; i < 4; ++i) window[r][i] = 0;
  }
  for (int i = 0; i < PER_CELL; ++i) keys[i] = 0;
  const int right = width - BORDER;
  const int bottom = height - BORDER;
  const uint high = (uint)threshold_high;
  int written = first_cell;
  int row_in_cell = 0;
  for (int y = 0; y <= bottom; ++y) {
    const int row = y - 1;  // of the window's centre
    int column = 0;
    int in_cell = 0;
    const int in_rows = row >= BORDER && row < bottom;
    const int row_ends = row_in_cell == cell - 1 || row == bottom - 1;
    PIPELINE(1)
    for (int x = 0; x < width + 2; x += 2) {
      UNROLL(3)
      for (int r = 0; r < 3; ++r) {
        window[r][0] = window[r][2];
        window[r][1] = window[r][3];
      }
      UNROLL(2)
      for (int l = 0; l < 2; ++l) {
        const uchar now = x + l < width ? score[y * width + x + l] : (uchar)0;
        window[0][2 + l] = lines[0][x + l];
        window[1][2 + l] = lines[1][x + l];
        window[2][2 + l] = now;
        lines[0][x + l] = window[1][2 + l];
        lines[1][x + l] = now;
      }
      // Centres x - 1 and x.
      if (in_rows && x - 1 >= BORDER && x - 1 < right) {
        uint key = 0;
        UNROLL(2)
        for (int l = 0; l < 2; ++l) {
          const uchar s = window[1][1 + l];
          const uchar before =
              max(max(window[0][l], window[0][l + 1]), max(window[0][l + 2], window[1][l]));
          const uchar after =
              max(max(window[2][l], window[2][l + 1]), max(window[2][l + 2], window[1][l + 2]));
          if (s > before && s >= after && x - 1 + l < right) key = corner_key(s, x - 1 + l, row);
        }
        UNROLL(PER_CELL)
        for (int i = 0; i < PER_CELL; ++i) {
          const uint old = in_cell != 0 ? keys[i] : row_in_cell != 0 ? kept[column][i] : 0u;
          keys[i] = max(old, key);
          key = min(old, key);
        }
        in_cell += 2;
        if (in_cell == cell || x + 1 >= right) {
          const int has_high = (keys[0] >> 24) > high;
          UNROLL(PER_CELL)
          for (int i = 0; i < PER_CELL; ++i) {
            kept[column][i] = keys[i];
            if (row_ends) {
              slots[written * PER_CELL + i] = has_high && (keys[i] >> 24) <= high ? 0u : keys[i];
            }
          }
          if (row_ends) ++written;
          ++column;
          in_cell = 0;
        }
      }
    }
    if (in_rows) row_in_cell = row_ends ? 0 : row_in_cell + 1;
  }
}
