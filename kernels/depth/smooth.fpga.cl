// Adaptive mean and median along rows or columns, FPGA variant.
// Assumes: pictures at most FPGA_WIDTH wide. One work-item streams the picture once, through as
// many row buffers as the filter has taps (in banks, so that all are read at once): one pixel per
// clock (II = 1). Pixels too near to a line's end stay as they are.
#include "common/fpga.clh"
#include "depth/smooth.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void adaptive_mean(
    __global const ushort* restrict map, __global ushort* restrict out, int width, int height,
    int vertical) {
  ushort lines[2 * MEAN_REACH + 1][FPGA_WIDTH] PARTITION_COMPLETE(1) PARTITION_CYCLIC(16, 2);
  const int ahead = vertical != 0 ? MEAN_REACH : 0;
  for (int row = 0; row < height + ahead; ++row) {
    const int y = row - ahead;  // the row that leaves
    PIPELINE(1)
    for (int x = 0; x < width; ++x) {
      if (row < height) lines[row % (2 * MEAN_REACH + 1)][x] = map[row * width + x];
    }
    if (y < 0) continue;
    const int length = vertical != 0 ? height : width;
    PIPELINE(1)
    for (int x = 0; x < width; ++x) {
      const int place = vertical != 0 ? y : x;
      const bool whole = place >= MEAN_REACH && place < length - MEAN_REACH;
      ushort taps[2 * MEAN_REACH + 1];
      UNROLL(2 * MEAN_REACH + 1)
      for (int k = 0; k < 2 * MEAN_REACH + 1; ++k) {
        const int line = (vertical != 0 && whole ? y + k - MEAN_REACH : y) % (2 * MEAN_REACH + 1);
        taps[k] = lines[line][vertical == 0 && whole ? x + k - MEAN_REACH : x];
      }
      out[y * width + x] = whole ? mean_of(taps) : taps[MEAN_REACH];
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void median(
    __global const ushort* restrict map, __global ushort* restrict out, int width, int height,
    int vertical) {
  ushort lines[2 * MEDIAN_REACH + 1][FPGA_WIDTH] PARTITION_COMPLETE(1) PARTITION_CYCLIC(16, 2);
  const int ahead = vertical != 0 ? MEDIAN_REACH : 0;
  for (int row = 0; row < height + ahead; ++row) {
    const int y = row - ahead;  // the row that leaves
    PIPELINE(1)
    for (int x = 0; x < width; ++x) {
      if (row < height) lines[row % (2 * MEDIAN_REACH + 1)][x] = map[row * width + x];
    }
    if (y < 0) continue;
    const int length = vertical != 0 ? height : width;
    PIPELINE(1)
    for (int x = 0; x < width; ++x) {
      const int place = vertical != 0 ? y : x;
      const bool whole = place >= MEDIAN_REACH && place < length - MEDIAN_REACH;
      ushort taps[2 * MEDIAN_REACH + 1];
      UNROLL(2 * MEDIAN_REACH + 1)
      for (int k = 0; k < 2 * MEDIAN_REACH + 1; ++k) {
        const int line =
            (vertical != 0 && whole ? y + k - MEDIAN_REACH : y) % (2 * MEDIAN_REACH + 1);
        taps[k] = lines[line][vertical == 0 && whole ? x + k - MEDIAN_REACH : x];
      }
      out[y * width + x] = whole ? median_of(taps) : taps[MEDIAN_REACH];
    }
  }
}
