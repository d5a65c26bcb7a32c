// The priors: disparities seen in each cell, and the planes' disparity at each pixel. CPU variant.
// Assumes: triangles' corners in order of row and column, inside the picture; slopes below those in
// planes.h. grid_seen, grid_prior: one work-item takes a row of cells; plane_prior: one takes BAND
// rows of pixels and meets every triangle. Local size 1.
#include "depth/constants.clh"
#include "depth/plane.clh"
#include "depth/seen.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void grid_seen(
    __global const short* restrict grid, __global uint* restrict seen, int columns, int rows,
    int cell, int grid_columns, int grid_rows, int step, int max_disparity, int right) {
  uint marks[MAX_COLUMNS * SEEN_WORDS];
  const int cy = (int)get_global_id(0);
  if (cy >= rows) return;
  mark_row(grid, marks, cy, columns, cell, grid_columns, grid_rows, step, max_disparity, right);
  __global uint* out = seen + (size_t)cy * (size_t)columns * SEEN_WORDS;
  for (int k = 0; k < columns * SEEN_WORDS; ++k) out[k] = marks[k];
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void grid_prior(
    __global const uint* restrict seen, __global ushort* restrict counts,
    __global uchar* restrict lists, int columns, int rows, int max_disparity) {
  const int cy = (int)get_global_id(0);
  for (int cx = 0; cx < columns; ++cx) {
    uint8 marks = (uint8)(0);
    for (int y = max(cy - 1, 0); y <= min(cy + 1, rows - 1); ++y) {
      for (int x = max(cx - 1, 0); x <= min(cx + 1, columns - 1); ++x) {
        marks |= vload8((size_t)(y * columns + x), seen);
      }
    }
    uint words[SEEN_WORDS];
    vstore8(marks, 0, words);
    const size_t at = (size_t)(cy * columns + cx);
    __global uchar* list = lists + at * (size_t)(max_disparity + 1);
    int n = 0;
    for (int d = 0; d <= max_disparity; ++d) {
      if (((words[d / 32] >> (d % 32)) & 1u) != 0) list[n++] = (uchar)d;
    }
    counts[at] = (ushort)n;
  }
}

static inline void fill_span(int4 plane, short8 c, int y, int width, __global short* map) {
  const int2 columns = span(c, y, width);
  const int row = plane_row(plane, c, y);
  __global short* out = map + (size_t)y * (size_t)width;
  const int16 lanes = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  int x = columns.x;
  for (; x + 16 <= columns.y; x += 16) {
    const int16 rise = (int16)(plane.x) * ((int16)(x - c.s0) + lanes) + (int16)(row);
    const int16 disparity = (int16)(plane.z << PLANE_BITS) + (rise >> (16 - PLANE_BITS));
    vstore16(convert_short16(plane.w != 0 ? disparity : (int16)(NO_PLANE)), 0, out + x);
  }
  for (; x < columns.y; ++x) out[x] = plane_at(plane, c, row, x);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void plane_prior(
    __global const short* restrict corners, __global const int* restrict planes,
    __global short* restrict map, int width, int height, int triangles) {
  const int top = (int)get_global_id(0) * BAND;
  const int bottom = min(top + BAND, height);
  for (size_t i = (size_t)top * (size_t)width; i < (size_t)bottom * (size_t)width; ++i) {
    map[i] = NO_PLANE;
  }
  for (int t = 0; t < triangles; ++t) {
    const short8 c = vload8((size_t)t, corners);
    if (c.s5 <= top || c.s1 >= bottom) continue;
    const int4 plane = vload4((size_t)t, planes);
    for (int y = max((int)c.s1, top); y < min((int)c.s5, bottom); ++y) {
      fill_span(plane, c, y, width, map);
    }
  }
}
