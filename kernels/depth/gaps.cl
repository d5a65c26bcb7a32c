// Fills the gaps of rows or of columns, GPU and FPGA.
// Assumes: any size. A work-item takes every n-th line, where n is the number of work-items; on an
// FPGA there is one, and a place is looked at per clock.
#include "depth/gaps.clh"

__kernel void fill_gaps(__global ushort* restrict map, int width, int height, int vertical, int gap,
                        int extend) {
  const int lines = vertical != 0 ? width : height;
  for (int line = (int)get_global_id(0); line < lines; line += (int)get_global_size(0)) {
    if (vertical != 0) {
      fill_line(map + line, width, height, gap, extend);
    } else {
      fill_line(map + (size_t)line * (size_t)width, 1, width, gap, extend);
    }
  }
}
