// Fills the gaps of rows or of columns, CPU variant.
// Assumes: any size. One work-item takes a row, or 16 columns side by side: along them it keeps the
// last disparity and the gap's length of each, and stops only where one of them has to be filled.
#include "depth/gaps.clh"

#define SIDE 16

static inline void fill_columns(__global ushort* map, int width, int height, int gap, int extend) {
  ushort16 before = (ushort16)(0);
  ushort16 count = (ushort16)(0);
  for (int y = 0; y < height; ++y) {
    const ushort16 d = vload16(0, map + (size_t)y * (size_t)width);
    const short16 there = d != (ushort16)(0);
    const short16 ends = there & (count != (ushort16)(0));
    if (any(ends) != 0) {
      ushort ended[SIDE], lengths[SIDE], befores[SIDE];
      vstore16(d & as_ushort16(ends), 0, ended);
      vstore16(count, 0, lengths);
      vstore16(before, 0, befores);
      for (int x = 0; x < SIDE; ++x) {
        if (ended[x] == 0) continue;
        const int length = lengths[x];
        if (befores[x] == 0) {
          if (extend != 0) fill(map + x, width, max(y - gap, 0), y, ended[x]);
        } else if (length <= gap) {
          fill(map + x, width, y - length, y, between(befores[x], ended[x]));
        }
      }
    }
    before = select(before, d, as_ushort16(there));
    count = (count + (ushort16)(1)) & ~as_ushort16(there);
  }
  if (extend == 0) return;
  ushort lengths[SIDE], befores[SIDE];
  vstore16(count, 0, lengths);
  vstore16(before, 0, befores);
  for (int x = 0; x < SIDE; ++x) {
    const int begin = height - (int)lengths[x];
    if (befores[x] != 0) fill(map + x, width, begin, min(begin + gap, height), befores[x]);
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void fill_gaps(
    __global ushort* restrict map, int width, int height, int vertical, int gap, int extend) {
  const int item = (int)get_global_id(0);
  if (vertical == 0) {
    fill_line(map + (size_t)item * (size_t)width, 1, width, gap, extend);
  } else if ((item + 1) * SIDE <= width) {
    fill_columns(map + item * SIDE, width, height, gap, extend);
  } else {
    for (int x = item * SIDE; x < width; ++x) fill_line(map + x, width, height, gap, extend);
  }
}
