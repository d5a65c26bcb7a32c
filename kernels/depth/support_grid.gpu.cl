// The support grid: plausible points, thinning, listing. GPU variant.
// Assumes: a grid of disparities, -1 for none; windows up to MAX_WINDOW. Plausible points: groups
// of 16 x 16 with their neighbourhood in local memory. Thinning: one line per work-item, 64 to a
// group, since a line has to be walked in order. Listing: one group of LISTERS, each takes rows, so
// that the list is in order of row and column whatever the timing.
#include "depth/constants.clh"
#include "depth/support_grid.clh"

#define SIDE 16
#define LISTERS 256

__kernel __attribute__((reqd_work_group_size(SIDE, SIDE, 1))) void support_plausible(
    __global const short* restrict grid, __global short* restrict out, int columns, int rows,
    int window, int threshold, int least) {
  __local short tile[(SIDE + 2 * MAX_WINDOW) * (SIDE + 2 * MAX_WINDOW)];
  const int stride = SIDE + 2 * window;
  const int left = (int)get_group_id(0) * SIDE - window;
  const int top = (int)get_group_id(1) * SIDE - window;
  for (int y = (int)get_local_id(1); y < stride; y += SIDE) {
    for (int x = (int)get_local_id(0); x < stride; x += SIDE) {
      const bool inside = left + x >= 0 && left + x < columns && top + y >= 0 && top + y < rows;
      tile[y * stride + x] = inside ? grid[(top + y) * columns + left + x] : (short)-1;
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const int i = (int)get_global_id(0);
  const int j = (int)get_global_id(1);
  if (i >= columns || j >= rows) return;
  __local const short* corner = tile + (int)get_local_id(1) * stride + (int)get_local_id(0);
  const short d = corner[window * stride + window];
  int count = 0;
  for (int y = 0; y <= 2 * window; ++y) {
    for (int x = 0; x <= 2 * window; ++x) {
      const short other = corner[y * stride + x];
      count += other >= 0 && max(other, d) - min(other, d) <= threshold ? 1 : 0;
    }
  }
  out[j * columns + i] = (short)(d >= 0 && count >= least ? d : -1);
}

__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void support_redundant(
    __global short* restrict grid, int columns, int rows, int vertical, int reach, int threshold) {
  const int line = (int)get_global_id(0);
  if (line < (vertical != 0 ? columns : rows)) {
    thin(grid, columns, rows, vertical, line, reach, threshold);
  }
}

__kernel __attribute__((reqd_work_group_size(LISTERS, 1, 1))) void support_list(
    __global const short* restrict grid, __global short* restrict list,
    __global uint* restrict count, int columns, int rows, int step) {
  __local int ends[LISTERS];
  const int lane = (int)get_local_id(0);
  const int share = (rows + LISTERS - 1) / LISTERS;
  const int begin = min(lane * share, rows);
  const int end = min(begin + share, rows);
  int mine = 0;
  for (int j = begin; j < end; ++j) mine += points_in_row(grid + j * columns, columns);
  ends[lane] = mine;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int reach = 1; reach < LISTERS; reach *= 2) {  // inclusive sums
    const int before = lane >= reach ? ends[lane - reach] : 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    ends[lane] += before;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  int n = ends[lane] - mine;
  for (int j = begin; j < end; ++j) {
    list_row(grid + j * columns, columns, j, step, list + n * 4);
    n += points_in_row(grid + j * columns, columns);
  }
  if (lane == LISTERS - 1) count[0] = (uint)ends[lane];
}
