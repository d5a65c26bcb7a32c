// The priors: disparities seen in each cell, and the planes' disparity at each pixel. FPGA variant.
// Assumes: triangles' corners in order of row and column, inside the picture; slopes below those in
// planes.h. One work-item; the innermost loops take one grid point, one disparity or one pixel per
// clock (II = 1). A cell's marks sit in registers.
#include "common/fpga.clh"
#include "depth/constants.clh"
#include "depth/plane.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void grid_prior(
    __global const short* restrict grid, __global ushort* restrict counts,
    __global uchar* restrict lists, int columns, int rows, int grid_columns, int grid_rows,
    int step, int max_disparity, int right) {
  const int reach = right != 0 ? max_disparity : 0;
  uchar seen[DISPARITIES + 2] PARTITION_COMPLETE(1);  // at d + 1
  for (int cell = 0, cx = 0, cy = 0; cell < columns * rows; ++cell) {
    UNROLL(DISPARITIES + 2)
    for (int k = 0; k < DISPARITIES + 2; ++k) seen[k] = 0;
    const int begin = (cx * CELL + step - 1) / step;
    const int end = min(((cx + 1) * CELL + reach + step - 1) / step, grid_columns);
    const int top = (cy * CELL + step - 1) / step;
    const int bottom = min(((cy + 1) * CELL + step - 1) / step, grid_rows);
    for (int j = top; j < bottom; ++j) {
      PIPELINE(1)
      for (int i = begin; i < end; ++i) {
        const int d = grid[j * grid_columns + i];
        const int u = i * step - (right != 0 ? d : 0) - cx * CELL;
        if (d < 0 || u < 0 || u >= CELL) continue;
        seen[d] = 1;
        seen[d + 1] = 1;
        seen[d + 2] = 1;
      }
    }
    __global uchar* list = lists + (size_t)cell * (size_t)(max_disparity + 1);
    int n = 0;
    PIPELINE(1)
    for (int d = 0; d <= max_disparity; ++d) {
      if (seen[d + 1] != 0) list[n++] = (uchar)d;
    }
    counts[cell] = (ushort)n;
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
