// A target's filter applied to its patches (see the GPU's text for how).
// Assumes: as there. FPGA variant: patch by patch; real and imaginary parts come through one port,
// two clocks an entry. Everything else takes an entry a clock.
#include "tracking/fourier.fpga.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void respond(
    __global const float* restrict kernels, __global const float* restrict filters,
    __global const int* restrict slots, __global const float* restrict twiddles,
    __global float* restrict peaks, int cells, int scales, int count) {
  float re[MAX_PLANE] PARTITION_CYCLIC(2, 1);
  float im[MAX_PLANE] PARTITION_CYCLIC(2, 1);
  float table[MAX_CELLS];
  const int size = cells * cells;
  const size_t stride = 2 * (size_t)size;
  const float over = 1.0f / (float)size;  // a power of two: exact
  load_twiddles(table, twiddles, cells);
  for (int p = 0; p < count; ++p) {
    __global const float* kernel_of = kernels + (size_t)p * stride;
    __global const float* filter = filters + (size_t)slots[p / scales] * stride;
    PIPELINE(2)
    for (int i = 0; i < size; ++i) {
      const float kr = kernel_of[i];
      const float ki = kernel_of[i + size];
      const float ar = filter[i];
      const float ai = filter[i + size];
      re[at(i, cells)] = fma(kr, ar, -(ki * ai));
      im[at(i, cells)] = fma(kr, ai, ki * ar);
    }
    inverse_plane(re, im, table, cells);
    int place = 0;
    float largest = re[0];
    PIPELINE(1)
    for (int i = 1; i < size; ++i) {
      const bool larger = re[i] > largest;
      place = larger ? i : place;
      largest = larger ? re[i] : largest;
    }
    const int row = place - place % cells;
    const int column = place - row;
    const int places[PEAK_ENTRIES] = {place,
                                      place,
                                      row + (column + cells - 1) % cells,
                                      row + (column + 1) % cells,
                                      (place + size - cells) % size,
                                      (place + cells) % size};
    PIPELINE(1)
    for (int k = 0; k < PEAK_ENTRIES; ++k) {
      peaks[p * PEAK_ENTRIES + k] = k == 1 ? (float)place : re[places[k]] * over;
    }
  }
}
