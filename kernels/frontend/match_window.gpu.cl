// For every query the feature in its window (see match.clh) with the least Hamming distance, ties
// to the smaller index: {index, distance}, or {-1, 65535} if there is none within max_hamming, or
// if the distance times 256 exceeds the second best's times ratio_q8 (at most 256, which lets every
// best pass; no second candidate counts as distance 65535). Queries whose shift.x is NO_PREDICTION
// get {-1, 65535}. Windows: x in [x_least, x_most] and y in [y_least, y_most] around position +
// shift.
// Assumes: trains < 65536; cell_start as compact wrote it for the grid of cell0, cell1 on width x
// height; |shift| below 2^22.
// 32 work-items per query, four queries per group: each takes every 32nd candidate of a run, then
// the bests are merged in local memory.
#include "frontend/match.clh"

#define LANES 32
#define PER_GROUP 4

__kernel __attribute__((reqd_work_group_size(LANES, PER_GROUP, 1))) void match_window(
    __global const int4* restrict queries, __global const uint8* restrict query_descriptors,
    __global const int2* restrict shifts, __global const int4* restrict trains,
    __global const uint8* restrict train_descriptors, __global const int* restrict cell_start,
    __global int2* restrict matches, int query_count, int width, int height, int cell0, int cell1,
    int x_least, int x_most, int y_least, int y_most, int max_hamming, int ratio_q8) {
  __local uint bests[PER_GROUP][LANES];
  __local int seconds[PER_GROUP][LANES];
  const int lane = (int)get_local_id(0);
  const int slot = (int)get_local_id(1);
  const int index = (int)get_global_id(1);
  uint best = 0xFFFFFFFFu;
  int second = NO_DISTANCE;
  if (index < query_count && shifts[index].x != NO_PREDICTION) {
    const int4 query = queries[index];
    const uint8 descriptor = query_descriptors[index];
    const int level = level_of(query);
    const int x0 = query.x + shifts[index].x + x_least;
    const int x1 = query.x + shifts[index].x + x_most;
    const int y0 = query.y + shifts[index].y + y_least;
    const int y1 = query.y + shifts[index].y + y_most;
    const CellRange range = cells_of(level, width, height, cell0, cell1, x0, x1, y0, y1);
    for (int row = range.row0; row <= range.row1 && range.column0 <= range.column1; ++row) {
      const int row_cell = range.first_cell + row * range.columns;
      const int from = cell_start[row_cell + range.column0];
      const int to = cell_start[row_cell + range.column1 + 1];
      for (int i = from + lane; i < to; i += LANES) {
        const int4 train = trains[i];
        if (train.x < x0 || train.x > x1 || train.y < y0 || train.y > y1) continue;
        const int distance = hamming_words(descriptor, train_descriptors[i]);
        const uint key = ((uint)distance << 16) | (uint)i;
        second = min(second, key < best ? (int)(best >> 16) : distance);
        best = min(best, key);
      }
    }
  }
  bests[slot][lane] = best;
  seconds[slot][lane] = second;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int half_row = LANES / 2; half_row > 0; half_row /= 2) {
    if (lane < half_row) {
      const uint other = bests[slot][lane + half_row];
      const int loser = (int)(max(best, other) >> 16);
      second = min(min(second, seconds[slot][lane + half_row]), loser);
      best = min(best, other);
      bests[slot][lane] = best;
      seconds[slot][lane] = second;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (lane == 0 && index < query_count)
    matches[index] = decide(best, second, max_hamming, ratio_q8);
}
