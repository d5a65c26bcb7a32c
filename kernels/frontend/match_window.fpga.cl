// Matches in a window (see the GPU's text for what they are).
// Assumes: as there, and at most 2,048 features and 512 cells.
// The features to search, their descriptors and the cells are copied on chip first. Per query one
// flat loop steps through the runs of its window, one candidate per cycle; carried are the running
// best and second, one compare-and-select each: II = 1.
#include "common/fpga.clh"
#include "frontend/match.clh"

#define MAX_TRAINS 2048
#define MAX_CELLS 512

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void match_window(
    __global const int4* restrict queries, __global const uint8* restrict query_descriptors,
    __global const int2* restrict shifts, __global const int4* restrict trains,
    __global const uint8* restrict train_descriptors, __global const int* restrict cell_start,
    __global int2* restrict matches, int query_count, int width, int height, int cell0, int cell1,
    int x_least, int x_most, int y_least, int y_most, int max_hamming, int ratio_q8) {
  int2 positions[MAX_TRAINS];
  uint8 descriptors[MAX_TRAINS];
  int starts[MAX_CELLS + 1];
  const int cells = cell_count(width, height, cell0, cell1);
  PIPELINE(1)
  for (int i = 0; i <= cells; ++i) starts[i] = cell_start[i];
  const int train_count = starts[cells];
  PIPELINE(1)
  for (int i = 0; i < train_count; ++i) {
    positions[i] = trains[i].xy;
    descriptors[i] = train_descriptors[i];
  }
  for (int index = 0; index < query_count; ++index) {
    const int2 shift = shifts[index];
    const int4 query = queries[index];
    const uint8 descriptor = query_descriptors[index];
    const int x0 = query.x + shift.x + x_least;
    const int x1 = query.x + shift.x + x_most;
    const int y0 = query.y + shift.y + y_least;
    const int y1 = query.y + shift.y + y_most;
    const int level = level_of(query);
    const CellRange range = cells_of(level, width, height, cell0, cell1, x0, x1, y0, y1);
    uint best = 0xFFFFFFFFu;
    int second = NO_DISTANCE;
    const int searched = shift.x != NO_PREDICTION && range.column0 <= range.column1;
    for (int row = range.row0; row <= range.row1 && searched; ++row) {
      const int row_cell = range.first_cell + row * range.columns;
      const int to = starts[row_cell + range.column1 + 1];
      PIPELINE(1)
      for (int i = starts[row_cell + range.column0]; i < to; ++i) {
        const int2 train = positions[i];
        const int inside = train.x >= x0 && train.x <= x1 && train.y >= y0 && train.y <= y1;
        const int distance = hamming_words(descriptor, descriptors[i]);
        const uint key = ((uint)distance << 16) | (uint)i;
        if (inside) {
          second = min(second, key < best ? (int)(best >> 16) : distance);
          best = min(best, key);
        }
      }
    }
    matches[index] = decide(best, second, max_hamming, ratio_q8);
  }
}
