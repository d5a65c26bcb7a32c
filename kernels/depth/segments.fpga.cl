// Segments of similar disparities; see segments.gpu.cl for what they are. FPGA variant.
// Assumes: pictures at most FPGA_WIDTH wide. One work-item; a row of disparities, and a band's
// labels and sizes, counted from the band's first pixel, wait on the chip. Uniting roots is a chain
// of dependent reads and sets the pace.
#include "depth/segments.clh"

#define NOWHERE 0xffff

static inline int band_root(__private const ushort* labels, int i) {
  while (labels[i] != i) i = labels[i];
  return i;
}

// First every pixel gets the root of its run, and roots of runs above each other are united under
// the least, once where they meet: that is when the pipeline waits.
static inline void label_row(__private ushort* above, __private ushort* labels,
                             __global const ushort* row, int first, int width, bool top,
                             int similarity) {
  int root = NOWHERE;
  int left = 0;
  int over_left = 0;  // above it, if it is alike
  PIPELINE(1)
  for (int x = 0; x < width; ++x) {
    const int i = first + x;
    const ushort d = row[x];
    const ushort over = top ? (ushort)0 : above[x];
    above[x] = d;
    const bool goes_on = alike(d, left, similarity);
    if (!goes_on) root = d != 0 ? i : NOWHERE;
    left = d;
    labels[i] = (ushort)root;
    const bool joined = alike(d, over, similarity);
    const bool known = goes_on && alike(over, over_left, similarity);
    over_left = joined ? over : 0;
    if (!joined || known) continue;
    const int other = band_root(labels, labels[i - width]);
    const int least = min(other, root);
    labels[other] = (ushort)least;
    labels[root] = (ushort)least;
    root = least;
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void segments(
    __global const ushort* restrict map, __global int* restrict labels,
    __global int* restrict sizes, int width, int height, int similarity) {
  ushort above[FPGA_WIDTH];
  ushort band_labels[BAND * FPGA_WIDTH];
  ushort band_sizes[BAND * FPGA_WIDTH];
  for (int top = 0; top < height; top += BAND) {
    const int rows = min(BAND, height - top);
    const int first = top * width;
    for (int y = 0; y < rows; ++y) {
      label_row(above, band_labels, map + first + y * width, y * width, width, y == 0, similarity);
    }
    // Roots come before what they hold: in order, a label's label is final.
    PIPELINE(2)
    for (int i = 0; i < rows * width; ++i) {
      band_sizes[i] = 0;
      if (band_labels[i] == NOWHERE) continue;
      const int root = band_labels[band_labels[i]];
      band_labels[i] = (ushort)root;
      band_sizes[root] += 1;
    }
    PIPELINE(1)
    for (int i = 0; i < rows * width; ++i) {
      labels[first + i] = band_labels[i] == NOWHERE ? -1 : first + band_labels[i];
      sizes[first + i] = band_sizes[i];
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void join_segments(
    __global const ushort* restrict map, __global int* restrict labels,
    __global int* restrict sizes, int width, int height, int similarity) {
  join_all(map, labels, sizes, width, height, similarity);
}
