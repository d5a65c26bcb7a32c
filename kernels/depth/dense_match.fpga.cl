// Dense maximum a-posteriori matching and the left-right check, FPGA variant.
// Assumes: 16-byte descriptors, row-major, at most FPGA_WIDTH wide; max_disparity <= 255; an
// ascending list of disparities per cell. One work-item: a row of either view's descriptors and the
// lists of its row of cells wait on the chip; one candidate is weighed per clock (II = 1).
#include "common/fpga.clh"
#include "depth/constants.clh"
#include "depth/distance_scalar.clh"
#include "depth/refine.clh"

#define NEVER 0xffffffffu
#define PRIOR_ENTRIES ((MAX_RADIUS << PLANE_BITS) + 2)

static inline uint weigh(uchar16 mine, uchar16 theirs, int penalty, int d) {
  const int energy = (distance16(mine, theirs) << ENERGY_SHIFT) + penalty;
  return ((uint)energy << 8) | (uint)d;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void dense_match(
    __global const uchar* restrict own, __global const uchar* restrict other,
    __global const short* restrict map, __global const ushort* restrict counts,
    __global const uchar* restrict lists, __global const ushort* restrict prior,
    __global ushort* restrict disparities, int width, int height, int cell, int max_disparity,
    int radius, int right, int texture) {
  uchar16 mine[FPGA_WIDTH];
  uchar16 line[FPGA_WIDTH];
  short planes[FPGA_WIDTH];
  ushort table[PRIOR_ENTRIES];
  const int columns = (width + cell - 1) / cell;
  const int around = 2 * radius;  // candidates of a plane
  const int entries = (radius << PLANE_BITS) + 2;
  const int direction = right != 0 ? 1 : -1;
  for (int k = 0; k < entries; ++k) table[k] = prior[k];
  for (int y = 0; y < height; ++y) {
    const size_t row = (size_t)y * (size_t)width;
    PIPELINE(2)
    for (int x = 0; x < width; ++x) {
      mine[x] = vload16(row + (size_t)x, own);
      line[x] = vload16(row + (size_t)x, other);
      planes[x] = map[row + (size_t)x];
    }
    for (int cx = 0; cx < columns; ++cx) {
      const size_t at = (size_t)((y / cell) * columns + cx);
      const int count = counts[at];
      uchar list[DISPARITIES];
      PIPELINE(1)
      for (int n = 0; n < count; ++n) list[n] = lists[at * (size_t)(max_disparity + 1) + (size_t)n];
      const int begin = cx * cell;
      const int pixels = min(cell, width - begin);
      uint best[MAX_CELL];
      for (int p = 0; p < pixels; ++p) best[p] = NEVER;
      // Candidate by candidate, pixel by pixel: a pixel comes round again after the whole cell, so
      // that its minimum is ready in time.
      PIPELINE(1)
      for (int n = 0, p = 0; n < around + count;
           p = p + 1 < pixels ? p + 1 : 0, n += p == 0 ? 1 : 0) {
        const int x = begin + p;
        const int room = min(max_disparity, right != 0 ? width - 1 - x : x);
        const int mu = planes[x];
        const bool of_plane = n < around;
        const int d = of_plane ? (mu >> PLANE_BITS) - radius + 1 + n : list[n - around];
        if (d < 0 || d > room || (of_plane && mu == NO_PLANE)) continue;
        const int off = (d << PLANE_BITS) - mu;
        const int entry = of_plane ? max(off, -off) : entries - 1;
        best[p] = min(best[p], weigh(mine[x], line[x + direction * d], table[entry], d));
      }
      PIPELINE(1)
      for (int p = 0; p < pixels; ++p) {
        const int x = begin + p;
        const bool none = best[p] == NEVER || texture16(mine[x]) < texture;
        const int d = (int)(best[p] & 255u);
        int offset = 0;
        if (right == 0 && !none && d > 0 && d < min(max_disparity, x)) {
          offset =
              refinement(distance16(mine[x], line[x - d + 1]), distance16(mine[x], line[x - d]),
                         distance16(mine[x], line[x - d - 1]));
        }
        disparities[row + (size_t)x] = (ushort)(none ? 0 : stored(d, offset));
      }
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void consistency(
    __global const ushort* restrict left, __global const ushort* restrict right,
    __global ushort* restrict out, int width, int height, int lr_threshold) {
  ushort line[FPGA_WIDTH];
  for (int y = 0; y < height; ++y) {
    const size_t row = (size_t)y * (size_t)width;
    PIPELINE(1)
    for (int x = 0; x < width; ++x) line[x] = right[row + (size_t)x];
    PIPELINE(1)
    for (int x = 0; x < width; ++x) {
      const int d = left[row + (size_t)x];
      const int column = x - ((d + 254) >> 8);
      const int back = line[max(column, 0)];
      const bool good =
          d > 0 && column >= 0 && back > 0 && max(d, back) - min(d, back) <= lr_threshold * 256;
      out[row + (size_t)x] = (ushort)(good ? d : 0);
    }
  }
}
