// The priors: disparities seen in each cell, and the planes' disparity at each pixel. GPU variant.
// Assumes: triangles' corners in order of row and column, inside the picture; slopes below those in
// planes.h. grid_seen, grid_prior: a group of 64 work-items takes a cell and marks bits in local
// memory; each work-item finds its disparities' places by counting the bits below. plane_prior: a
// group of 64 takes BAND rows of pixels, its work-items share out the triangles; each pixel has one
// triangle.
#include "depth/constants.clh"
#include "depth/plane.clh"

#define GROUP 64

__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void grid_seen(
    __global const short* restrict grid, __global uint* restrict seen, int columns, int rows,
    int cell, int grid_columns, int grid_rows, int step, int max_disparity, int right) {
  __local uint marks[SEEN_WORDS];
  const int lane = (int)get_local_id(0);
  const int cx = (int)get_group_id(0);
  const int cy = (int)get_group_id(1);
  if (cx >= columns || cy >= rows) return;
  if (lane < SEEN_WORDS) marks[lane] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  const int top = (cy * cell + step - 1) / step;
  const int bottom = min(((cy + 1) * cell + step - 1) / step, grid_rows);
  const int reach = right != 0 ? max_disparity : 0;
  const int begin = (cx * cell + step - 1) / step;
  const int end = min(((cx + 1) * cell + reach + step - 1) / step, grid_columns);
  for (int j = top; j < bottom; ++j) {
    for (int i = begin + lane; i < end; i += GROUP) {
      const int d = grid[j * grid_columns + i];
      const int u = i * step - (right != 0 ? d : 0) - cx * cell;
      if (d < 0 || u < 0 || u >= cell) continue;
      for (int bit = max(d - 1, 0); bit <= min(d + 1, max_disparity); ++bit) {
        atomic_or(&marks[bit / 32], 1u << (bit % 32));
      }
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane < SEEN_WORDS) seen[(cy * columns + cx) * SEEN_WORDS + lane] = marks[lane];
}

__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void grid_prior(
    __global const uint* restrict seen, __global ushort* restrict counts,
    __global uchar* restrict lists, int columns, int rows, int max_disparity) {
  __local uint marks[SEEN_WORDS];
  const int lane = (int)get_local_id(0);
  const int cx = (int)get_group_id(0);
  const int cy = (int)get_group_id(1);
  if (cx >= columns || cy >= rows) return;
  if (lane < SEEN_WORDS) {
    uint word = 0;
    for (int y = max(cy - 1, 0); y <= min(cy + 1, rows - 1); ++y) {
      for (int x = max(cx - 1, 0); x <= min(cx + 1, columns - 1); ++x) {
        word |= seen[(y * columns + x) * SEEN_WORDS + lane];
      }
    }
    marks[lane] = word;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const int at = cy * columns + cx;
  __global uchar* list = lists + (size_t)at * (size_t)(max_disparity + 1);
  for (int d = lane; d <= max_disparity; d += GROUP) {
    if (((marks[d / 32] >> (d % 32)) & 1u) == 0) continue;
    int place = 0;
    for (int w = 0; w < d / 32; ++w) place += (int)popcount(marks[w]);
    place += (int)popcount(marks[d / 32] & ((1u << (d % 32)) - 1u));
    list[place] = (uchar)d;
  }
  if (lane == 0) {
    int n = 0;
    for (int w = 0; w < SEEN_WORDS; ++w) n += (int)popcount(marks[w]);
    counts[at] = (ushort)n;
  }
}

__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void plane_prior(
    __global const short* restrict corners, __global const int* restrict planes,
    __global short* restrict map, int width, int height, int triangles) {
  const int lane = (int)get_local_id(0);
  const int top = (int)get_group_id(0) * BAND;
  const int bottom = min(top + BAND, height);
  __global short* band = map + (size_t)top * (size_t)width;
  for (int i = lane; i < (bottom - top) * width; i += GROUP) band[i] = NO_PLANE;
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int t = lane; t < triangles; t += GROUP) {
    const short8 c = vload8((size_t)t, corners);
    if (c.s5 <= top || c.s1 >= bottom) continue;
    const int4 plane = vload4((size_t)t, planes);
    for (int y = max((int)c.s1, top); y < min((int)c.s5, bottom); ++y) {
      const int2 columns = span(c, y, width);
      const int row = plane_row(plane, c, y);
      for (int x = columns.x; x < columns.y; ++x) {
        band[(y - top) * width + x] = plane_at(plane, c, row, x);
      }
    }
  }
}
