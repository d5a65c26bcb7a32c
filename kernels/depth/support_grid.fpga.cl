// The support grid: plausible points, thinning, listing. FPGA variant.
// Assumes: a grid of disparities, -1 for none, at most FPGA_COLUMNS wide; windows up to MAX_WINDOW.
// One work-item. Plausible points: the rows of the window wait in line buffers, one bank each;
// every clock counts one column of the window (II = 1, all its rows side by side). Thinning walks
// lines in order, one neighbour pair per clock.
#include "common/fpga.clh"
#include "depth/constants.clh"
#include "depth/support_grid.clh"

#define LINES (2 * MAX_WINDOW + 1)

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void support_plausible(
    __global const short* restrict grid, __global short* restrict out, int columns, int rows,
    int window, int threshold, int least) {
  short line[LINES][FPGA_COLUMNS] PARTITION_COMPLETE(1);
  for (int y = -window; y < rows + window; ++y) {
    const int slot = (y + window) % LINES;
    PIPELINE(1)
    for (int i = 0; i < columns; ++i) {
      line[slot][i] = y >= 0 && y < rows ? grid[y * columns + i] : (short)-1;
    }
    const int j = y - window;  // its window is complete now
    if (j < 0) continue;
    for (int i = 0; i < columns; ++i) {
      const short d = line[(j + window) % LINES][i];
      int count = 0;
      PIPELINE(1)
      for (int x = max(i - window, 0); x <= min(i + window, columns - 1); ++x) {
        UNROLL(LINES)
        for (int k = -window; k <= window; ++k) {
          const short other = line[(j + k + window) % LINES][x];
          count += other >= 0 && max(other, d) - min(other, d) <= threshold ? 1 : 0;
        }
      }
      out[j * columns + i] = (short)(d >= 0 && count >= least ? d : -1);
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void support_redundant(
    __global short* restrict grid, int columns, int rows, int vertical, int reach, int threshold) {
  const int lines = vertical != 0 ? columns : rows;
  for (int line = 0; line < lines; ++line) {
    thin(grid, columns, rows, vertical, line, reach, threshold);
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void support_list(
    __global const short* restrict grid, __global short* restrict list,
    __global uint* restrict count, int columns, int rows, int step) {
  int n = 0;
  for (int j = 0; j < rows; ++j) {
    PIPELINE(1)
    for (int i = 0; i < columns; ++i) {
      const short d = grid[j * columns + i];
      if (d < 0) continue;
      vstore4((short4)((short)(i * step), (short)(j * step), d, 0), (size_t)n, list);
      ++n;
    }
  }
  count[0] = (uint)n;
}
