// Matches in a window (see the GPU's text for what they are).
// Assumes: as there.
// One work-item per 32 queries; a descriptor is one vector of eight words.
#include "frontend/match.clh"

#define PER_ITEM 32

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void match_window(
    __global const int4* restrict queries, __global const uint8* restrict query_descriptors,
    __global const int2* restrict shifts, __global const int4* restrict trains,
    __global const uint8* restrict train_descriptors, __global const int* restrict cell_start,
    __global int2* restrict matches, int query_count, int width, int height, int cell0, int cell1,
    int x_least, int x_most, int y_least, int y_most, int max_hamming, int ratio_q8) {
  const int first = (int)get_global_id(0) * PER_ITEM;
  const int last = min(first + PER_ITEM, query_count);
  for (int index = first; index < last; ++index) {
    const int2 shift = shifts[index];
    if (shift.x == NO_PREDICTION) {
      matches[index] = (int2)(-1, NO_DISTANCE);
      continue;
    }
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
    for (int row = range.row0; row <= range.row1 && range.column0 <= range.column1; ++row) {
      const int row_cell = range.first_cell + row * range.columns;
      const int from = cell_start[row_cell + range.column0];
      const int to = cell_start[row_cell + range.column1 + 1];
      for (int i = from; i < to; ++i) {
        const int4 train = trains[i];
        if (train.x < x0 || train.x > x1 || train.y < y0 || train.y > y1) continue;
        const int distance = hamming_vector(descriptor, train_descriptors[i]);
        const uint key = ((uint)distance << 16) | (uint)i;
        second = min(second, key < best ? (int)(best >> 16) : distance);
        best = min(best, key);
      }
    }
    matches[index] = decide(best, second, max_hamming, ratio_q8);
  }
}
