// Segments of similar disparities; see segments.gpu.cl for what they are. CPU variant.
// Assumes: pictures at most MAX_WIDTH wide. segments: one work-item takes a band of BAND rows;
// join_segments: one takes everything, for there are few borders. Local size 1.
#include "depth/segments.clh"

#define MAX_WIDTH 4096

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void segments(
    __global const ushort* restrict map, __global int* restrict labels, __global int* restrict sizes,
    int width, int height, int similarity) {
  ushort band[BAND * MAX_WIDTH];
  int band_labels[BAND * MAX_WIDTH];
  int band_sizes[BAND * MAX_WIDTH];
  const int top = (int)get_global_id(0) * BAND;
  const int rows = min(BAND, height - top);
  const int first = top * width;
  for (int i = 0; i < rows * width; ++i) band[i] = map[first + i];
  label_band(band, band_labels, band_sizes, width, rows, similarity);
  for (int i = 0; i < rows * width; ++i) {
    labels[first + i] = band_labels[i] + (band_labels[i] < 0 ? 0 : first);
    sizes[first + i] = band_sizes[i];
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void join_segments(
    __global const ushort* restrict map, __global int* restrict labels, __global int* restrict sizes,
    int width, int height, int similarity) {
  join_all(map, labels, sizes, width, height, similarity);
}
