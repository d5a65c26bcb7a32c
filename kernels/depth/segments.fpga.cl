// Segments of similar disparities; see segments.gpu.cl for what they are. FPGA variant.
// Assumes: pictures at most FPGA_WIDTH wide. One work-item; a band of BAND rows, its labels and its
// sizes wait on the chip. Uniting roots is a chain of dependent reads and sets the pace.
#include "depth/segments.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void segments(
    __global const ushort* restrict map, __global int* restrict labels, __global int* restrict sizes,
    int width, int height, int similarity) {
  ushort band[BAND * FPGA_WIDTH];
  int band_labels[BAND * FPGA_WIDTH];
  int band_sizes[BAND * FPGA_WIDTH];
  for (int top = 0; top < height; top += BAND) {
    const int rows = min(BAND, height - top);
    const int first = top * width;
    PIPELINE(1)
    for (int i = 0; i < rows * width; ++i) band[i] = map[first + i];
    label_band(band, band_labels, band_sizes, width, rows, similarity);
    PIPELINE(1)
    for (int i = 0; i < rows * width; ++i) {
      labels[first + i] = band_labels[i] + (band_labels[i] < 0 ? 0 : first);
      sizes[first + i] = band_sizes[i];
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void join_segments(
    __global const ushort* restrict map, __global int* restrict labels, __global int* restrict sizes,
    int width, int height, int similarity) {
  join_all(map, labels, sizes, width, height, similarity);
}
