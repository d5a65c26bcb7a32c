// Dense maximum a-posteriori matching and the left-right check, FPGA variant.
// Assumes: 16-byte descriptors, row-major, at most FPGA_WIDTH wide; max_disparity <= 255; an
// ascending list of disparities per cell. One work-item: a row of either view's descriptors and the
// lists of its row of cells wait on the chip; one candidate is weighed per clock (II = 1).
#include "common/fpga.clh"
#include "depth/constants.clh"
#include "depth/distance_scalar.clh"

#define NEVER 0xffffffffu

static inline uint weigh(uchar16 mine, uchar16 theirs, int penalty, int d) {
  const int energy = (distance16(mine, theirs) << ENERGY_SHIFT) + penalty;
  return ((uint)energy << 8) | (uint)d;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void dense_match(
    __global const uchar* restrict own, __global const uchar* restrict other,
    __global const short* restrict map, __global const ushort* restrict counts,
    __global const uchar* restrict lists, __global const ushort* restrict prior,
    __global short* restrict disparities, int width, int height, int max_disparity, int right,
    int texture) {
  uchar16 mine[FPGA_WIDTH];
  uchar16 line[FPGA_WIDTH];
  short planes[FPGA_WIDTH];
  ushort table[PRIOR_ENTRIES];
  const int columns = (width + CELL - 1) / CELL;
  const int direction = right != 0 ? 1 : -1;
  for (int k = 0; k < PRIOR_ENTRIES; ++k) table[k] = prior[k];
  for (int y = 0; y < height; ++y) {
    const size_t row = (size_t)y * (size_t)width;
    PIPELINE(2)
    for (int x = 0; x < width; ++x) {
      mine[x] = vload16(row + (size_t)x, own);
      line[x] = vload16(row + (size_t)x, other);
      planes[x] = map[row + (size_t)x];
    }
    for (int cx = 0; cx < columns; ++cx) {
      const size_t cell = (size_t)((y / CELL) * columns + cx);
      const int count = counts[cell];
      uchar list[DISPARITIES];
      PIPELINE(1)
      for (int n = 0; n < count; ++n)
        list[n] = lists[cell * (size_t)(max_disparity + 1) + (size_t)n];
      const int begin = cx * CELL;
      const int pixels = min(CELL, width - begin);
      uint best[CELL];
      for (int p = 0; p < pixels; ++p) best[p] = NEVER;
      // Candidate by candidate, pixel by pixel: a pixel comes round again after the whole cell, so
      // that its minimum is ready in time.
      PIPELINE(1)
      for (int n = 0, p = 0; n < 4 + count; p = p + 1 < pixels ? p + 1 : 0, n += p == 0 ? 1 : 0) {
        const int x = begin + p;
        const int room = min(max_disparity, right != 0 ? width - 1 - x : x);
        const int mu = planes[x];
        const int d = n < 4 ? (mu >> PLANE_BITS) - 1 + n : list[n - 4];
        if (d < 0 || d > room || (n < 4 && mu == NO_PLANE)) continue;
        const int off = (d << PLANE_BITS) - mu;
        const int entry = n < 4 ? max(off, -off) : PRIOR_ENTRIES - 1;
        best[p] = min(best[p], weigh(mine[x], line[x + direction * d], table[entry], d));
      }
      PIPELINE(1)
      for (int p = 0; p < pixels; ++p) {
        const bool none = best[p] == NEVER || texture16(mine[begin + p]) < texture;
        disparities[row + (size_t)(begin + p)] = (short)(none ? -1 : (int)(best[p] & 255u));
      }
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void consistency(
    __global const short* restrict left, __global const short* restrict right,
    __global ushort* restrict out, int width, int height, int lr_threshold) {
  short line[FPGA_WIDTH];
  for (int y = 0; y < height; ++y) {
    const size_t row = (size_t)y * (size_t)width;
    PIPELINE(1)
    for (int x = 0; x < width; ++x) line[x] = right[row + (size_t)x];
    PIPELINE(1)
    for (int x = 0; x < width; ++x) {
      const int d = left[row + (size_t)x];
      const int back = line[clamp(x - d, 0, width - 1)];
      const bool good =
          d >= 0 && d <= x && back >= 0 && max(d, back) - min(d, back) <= lr_threshold;
      out[row + (size_t)x] = (ushort)(good ? max(d * 256, 1) : 0);
    }
  }
}
