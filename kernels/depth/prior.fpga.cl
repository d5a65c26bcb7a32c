// The priors: disparities seen in each cell, and the planes' disparity at each pixel. FPGA variant.
// Assumes: triangles' corners in order of row and column, inside the picture; slopes below those in
// planes.h. One work-item; the innermost loops take one grid point, one disparity or one pixel per
// clock (II = 1). A cell's marks sit in registers.
#include "common/fpga.clh"
#include "depth/constants.clh"
#include "depth/plane.clh"
#include "depth/seen.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void grid_seen(
    __global const short* restrict grid, __global uint* restrict seen, int columns, int rows,
    int cell, int grid_columns, int grid_rows, int step, int max_disparity, int right) {
  uint marks[(FPGA_WIDTH / MIN_CELL) * SEEN_WORDS] PARTITION_CYCLIC(SEEN_WORDS, 1);
  for (int cy = 0; cy < rows; ++cy) {
    mark_row(grid, marks, cy, columns, cell, grid_columns, grid_rows, step, max_disparity, right);
    PIPELINE(1)
    for (int k = 0; k < columns * SEEN_WORDS; ++k) {
      seen[(size_t)cy * (size_t)columns * SEEN_WORDS + (size_t)k] = marks[k];
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void grid_prior(
    __global const uint* restrict seen, __global ushort* restrict counts,
    __global uchar* restrict lists, int columns, int rows, int max_disparity) {
  uint words[SEEN_WORDS] PARTITION_COMPLETE(1);
  for (int at = 0, cx = 0, cy = 0; at < columns * rows; ++at) {
    UNROLL(SEEN_WORDS)
    for (int k = 0; k < SEEN_WORDS; ++k) words[k] = 0;
    for (int y = max(cy - 1, 0); y <= min(cy + 1, rows - 1); ++y) {
      PIPELINE(1)
      for (int x = max(cx - 1, 0); x <= min(cx + 1, columns - 1); ++x) {
        UNROLL(SEEN_WORDS)
        for (int k = 0; k < SEEN_WORDS; ++k) words[k] |= seen[(y * columns + x) * SEEN_WORDS + k];
      }
    }
    __global uchar* list = lists + (size_t)at * (size_t)(max_disparity + 1);
    int n = 0;
    PIPELINE(1)
    for (int d = 0; d <= max_disparity; ++d) {
      if (((words[d / 32] >> (d % 32)) & 1u) != 0) list[n++] = (uchar)d;
    }
    counts[at] = (ushort)n;
    cx = cx + 1 < columns ? cx + 1 : 0;
    cy = cx == 0 ? cy + 1 : cy;
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void plane_prior(
    __global const short* restrict corners, __global const int* restrict planes,
    __global short* restrict map, int width, int height, int triangles) {
  PIPELINE(1)
  for (size_t i = 0; i < (size_t)width * (size_t)height; ++i) map[i] = NO_PLANE;
  for (int t = 0; t < triangles; ++t) {
    const short8 c = vload8((size_t)t, corners);
    const int4 plane = vload4((size_t)t, planes);
    for (int y = max((int)c.s1, 0); y < min((int)c.s5, height); ++y) {
      const int2 columns = span(c, y, width);
      const int row = plane_row(plane, c, y);
      PIPELINE(1)
      for (int x = columns.x; x < columns.y; ++x) {
        map[(size_t)y * (size_t)width + (size_t)x] = plane_at(plane, c, row, x);
      }
    }
  }
}
