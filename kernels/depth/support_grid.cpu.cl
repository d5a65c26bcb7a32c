// The support grid: plausible points, thinning, listing. CPU variant.
// Assumes: a grid of disparities, -1 for none. One work-item takes one row of the grid (one line
// when thinning; everything when listing), local size 1. The window of 16 neighbours is counted at
// once where it lies inside the grid.
#include "depth/constants.clh"
#include "depth/support_grid.clh"

static inline int supporters(__global const short* restrict grid, int columns, int i, int begin,
                             int end, int window, int threshold) {
  const int d = grid[i];
  int count = 0;
  for (int y = begin; y < end; ++y) {
    for (int x = max(i - window, 0); x <= min(i + window, columns - 1); ++x) {
      const int other = grid[y * columns + x];
      count += other >= 0 && max(other, d) - min(other, d) <= threshold ? 1 : 0;
    }
  }
  return count;
}

static inline short16 supporters16(__global const short* restrict grid, int columns, int i,
                                   int begin, int end, int window, int threshold) {
  const short16 d = vload16(0, grid + i);
  short16 count = (short16)(0);
  for (int y = begin; y < end; ++y) {
    for (int x = -window; x <= window; ++x) {
      const short16 other = vload16(0, grid + y * columns + i + x);
      const short16 off = max(other, d) - min(other, d);
      count -= (off <= (short16)((short)threshold)) & (other >= (short16)(0));
    }
  }
  return count;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void support_plausible(
    __global const short* restrict grid, __global short* restrict out, int columns, int rows,
    int window, int threshold, int least) {
  const int j = (int)get_global_id(0);
  __global const short* row = grid + j * columns;
  __global short* out_row = out + j * columns;
  const int begin = max(j - window, 0) - j;
  const int end = min(j + window, rows - 1) - j + 1;
  int i = 0;
  while (i < columns) {
    if (i >= window && i + 15 + window < columns) {
      const short16 d = vload16(0, row + i);
      const short16 count = supporters16(row, columns, i, begin, end, window, threshold);
      const short16 keep = (count >= (short16)((short)least)) & (d >= (short16)(0));
      vstore16((d & keep) | ~keep, 0, out_row + i);
      i += 16;
    } else {
      const short d = row[i];
      const int count = supporters(row, columns, i, begin, end, window, threshold);
      out_row[i] = (short)(d >= 0 && count >= least ? d : -1);
      ++i;
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void support_redundant(
    __global short* restrict grid, int columns, int rows, int vertical, int reach, int threshold) {
  thin(grid, columns, rows, vertical, (int)get_global_id(0), reach, threshold);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void support_list(
    __global const short* restrict grid, __global short* restrict list,
    __global uint* restrict count, int columns, int rows, int step) {
  int n = 0;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const short d = grid[j * columns + i];
      if (d < 0) continue;
      vstore4((short4)((short)(i * step), (short)(j * step), d, 0), (size_t)n, list);
      ++n;
    }
  }
  count[0] = (uint)n;
}
