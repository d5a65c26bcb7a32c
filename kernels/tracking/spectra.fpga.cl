// Two-dimensional Fourier transforms of real planes (see the GPU's text for how).
// Assumes: as there. FPGA variant: plane by plane: in, 2 log2(cells) stages, out.
#include "tracking/fourier.fpga.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void spectra(
    __global const float* restrict planes, __global const float* restrict twiddles,
    __global float* restrict spectra, int cells, int count) {
  float re[MAX_PLANE] PARTITION_CYCLIC(2, 1);
  float im[MAX_PLANE] PARTITION_CYCLIC(2, 1);
  float table[MAX_CELLS];
  const int size = cells * cells;
  load_twiddles(table, twiddles, cells);
  for (int p = 0; p < count; ++p) {
    PIPELINE(1)
    for (int i = 0; i < size; ++i) {
      re[i] = planes[(size_t)p * (size_t)size + (size_t)i];
      im[i] = 0.0f;
    }
    forward_plane(re, im, table, cells);
    PIPELINE(1)
    for (int i = 0; i < 2 * size; ++i) {
      const int entry = at(i % size, cells);
      spectra[(size_t)p * 2 * (size_t)size + (size_t)i] = i < size ? re[entry] : im[entry];
    }
  }
}
