// The list of features: all used slots, cell by cell, as keypoints in original coordinates.
// cell_start[i] is the index of cell i's first keypoint, cell_start[cells] and count[0] their
// number. The first cells_level0 cells are of level 0, the others of level 1. Keypoints beyond the
// number are left alone.
// Assumes: cells >= 1; in every cell the used slots come first; keypoints has room for all. One
// group of 256: each work-item counts a run of cells, a prefix sum in local memory gives each run
// its place.
#include "frontend/common.clh"

#define GROUP 256

__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void compact(
    __global const uint* restrict slots, __global int4* restrict keypoints,
    __global int* restrict cell_start, __global int* restrict count, int cells, int cells_level0) {
  __local int sums[2][GROUP];
  const int lane = (int)get_local_id(0);
  const int run = (cells + GROUP - 1) / GROUP;
  const int first = min(lane * run, cells);
  const int last = min(first + run, cells);
  int mine = 0;
  for (int i = first * PER_CELL; i < last * PER_CELL; ++i) mine += slots[i] != 0 ? 1 : 0;
  sums[0][lane] = mine;
  barrier(CLK_LOCAL_MEM_FENCE);
  int from = 0;
  for (int step = 1; step < GROUP; step *= 2) {
    sums[1 - from][lane] = sums[from][lane] + (lane >= step ? sums[from][lane - step] : 0);
    from = 1 - from;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  int at = sums[from][lane] - mine;
  for (int i = first; i < last; ++i) {
    cell_start[i] = at;
    const int level = i < cells_level0 ? 0 : 1;
    for (int k = 0; k < PER_CELL; ++k) {
      const uint key = slots[i * PER_CELL + k];
      if (key != 0) keypoints[at++] = keypoint_of(key, level);
    }
  }
  if (lane == GROUP - 1) {
    cell_start[cells] = sums[from][lane];
    count[0] = sums[from][lane];
  }
}
