// The list of features (see the GPU's text for what it is), for CPU and FPGA.
// Assumes: cells >= 1; in every cell the used slots come first; keypoints has room for all. A
// single work-item: the list is short, and its order is the order of the slots. Carried from slot
// to slot is the index, one addition: II = 1.
#include "common/fpga.clh"
#include "frontend/common.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void compact(
    __global const uint* restrict slots, __global int4* restrict keypoints,
    __global int* restrict cell_start, __global int* restrict count, int cells, int cells_level0) {
  int at = 0;
  PIPELINE(1)
  for (int i = 0; i < cells * PER_CELL; ++i) {
    const int cell = i / PER_CELL;
    if (i % PER_CELL == 0) cell_start[cell] = at;
    const uint key = slots[i];
    if (key != 0) keypoints[at++] = keypoint_of(key, cell < cells_level0 ? 0 : 1);
  }
  cell_start[cells] = at;
  count[0] = at;
}
