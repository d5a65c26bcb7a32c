// Removes the segments that are too small, for all variants.
// Assumes: labels and sizes as join_segments leaves them. A work-item takes every n-th row, where n
// is the number of work-items; on an FPGA there is one.
#include "common/fpga.clh"

__kernel void remove_speckles(__global ushort* restrict map, __global const int* restrict labels,
                              __global const int* restrict sizes, int width, int height,
                              int least) {
  for (int y = (int)get_global_id(0); y < height; y += (int)get_global_size(0)) {
    PIPELINE(4)
    for (int i = y * width; i < (y + 1) * width; ++i) {
      const ushort d = map[i];
      const int root = labels[max(labels[i], 0)];
      const bool keep = sizes[max(root, 0)] >= least;
      map[i] = keep ? d : (ushort)0;
    }
  }
}
