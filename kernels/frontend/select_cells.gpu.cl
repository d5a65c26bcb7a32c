// The best corners of every cell: 3 x 3 non-maximum suppression (ties: the smaller row, then
// column), then the PER_CELL greatest keys of each cell of cell x cell pixels, in falling order, 0
// where there are fewer. In a cell whose best exceeds threshold_high, corners that do not are
// dropped: the lower threshold of fast_score serves cells that have no better.
// The grid begins at (BORDER, BORDER) and has ceil((width - 2 BORDER) / cell) columns, rows
// likewise; cell i of the image writes slots (first_cell + i) * PER_CELL and following.
// Assumes: width, height > 2 BORDER, at most 4096; stride == width; cell even, at least 2. One
// group of 16 x 4 per cell: every work-item keeps the best of its pixels, then PER_CELL rounds take
// the greatest of all heads. Keys contain the position, so no two are equal.
#include "frontend/common.clh"

#define GROUP_X 16
#define GROUP_Y 4
#define GROUP (GROUP_X * GROUP_Y)

static inline uint survivor(__global const uchar* p, int width, int x, int y) {
  const uchar s = p[0];
  if (s == 0) return 0;
  __global const uchar* above = p - width;
  __global const uchar* below = p + width;
  const uchar before = max(max(above[-1], above[0]), max(above[1], p[-1]));
  const uchar after = max(max(below[-1], below[0]), max(below[1], p[1]));
  return s > before && s >= after ? corner_key(s, x, y) : 0;
}

__kernel __attribute__((reqd_work_group_size(GROUP_X, GROUP_Y, 1))) void select_cells(
    __global const uchar* restrict score, __global uint* restrict slots, int width, int height,
    int cell, int first_cell, int threshold_high) {
  __local uint heads[GROUP];
  const int columns = (width - 2 * BORDER + cell - 1) / cell;
  const int column = (int)get_group_id(0);
  const int row = (int)get_group_id(1);
  const int index = row * columns + column;
  const int left = BORDER + column * cell;
  const int top = BORDER + row * cell;
  const int right = min(left + cell, width - BORDER);
  const int bottom = min(top + cell, height - BORDER);
  const int lane = (int)get_local_id(1) * GROUP_X + (int)get_local_id(0);

  uint k0 = 0, k1 = 0, k2 = 0, k3 = 0;
  for (int y = top + (int)get_local_id(1); y < bottom; y += GROUP_Y) {
    for (int x = left + (int)get_local_id(0); x < right; x += GROUP_X) {
      uint key = survivor(score + y * width + x, width, x, y);
      const uint m0 = max(k0, key);
      key = min(k0, key);
      const uint m1 = max(k1, key);
      key = min(k1, key);
      const uint m2 = max(k2, key);
      key = min(k2, key);
      k3 = max(k3, key);
      k0 = m0;
      k1 = m1;
      k2 = m2;
    }
  }

  uint best = 0;
  for (int round = 0; round < PER_CELL; ++round) {
    heads[lane] = k0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int half_group = GROUP / 2; half_group > 0; half_group /= 2) {
      if (lane < half_group) heads[lane] = max(heads[lane], heads[lane + half_group]);
      barrier(CLK_LOCAL_MEM_FENCE);
    }
    uint greatest = heads[0];
    barrier(CLK_LOCAL_MEM_FENCE);
    if (greatest != 0 && greatest == k0) {
      k0 = k1;
      k1 = k2;
      k2 = k3;
      k3 = 0;
    }
    if (round == 0) best = greatest;
    const uint high = (uint)threshold_high;
    if ((best >> 24) > high && (greatest >> 24) <= high) greatest = 0;
    if (lane == 0) slots[(first_cell + index) * PER_CELL + round] = greatest;
  }
}
