// Two-dimensional Fourier transforms of real planes: radix-2 butterflies, decimation in frequency,
// down the columns and then along the rows. Spectra stay in the order that this leaves them in:
// transposed, both frequencies bit-reversed (see host/tasks/tracking/golden.h).
// Assumes: cells 16 or 32. `twiddles`: cos, then sin, of 2 pi j / cells for j < cells / 2. GPU
// variant: a work-group takes a plane.
#include "tracking/fourier.gpu.clh"

__kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void spectra(
    __global const float* restrict planes, __global const float* restrict twiddles,
    __global float* restrict spectra, int cells, int count) {
  __local float re[MAX_PLANE];
  __local float im[MAX_PLANE];
  const int size = cells * cells;
  const size_t p = get_group_id(0);
  if (p >= (size_t)count) return;  // the whole group
  for (int i = (int)get_local_id(0); i < size; i += ITEMS) {
    re[i] = planes[p * (size_t)size + (size_t)i];
    im[i] = 0.0f;
  }
  forward_plane(re, im, twiddles, cells);
  __global float* out = spectra + 2 * p * (size_t)size;
  for (int i = (int)get_local_id(0); i < size; i += ITEMS) {
    out[i] = re[at(i, cells)];
    out[i + size] = im[at(i, cells)];
  }
}
