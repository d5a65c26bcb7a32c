// Two-dimensional Fourier transforms of real planes (see the GPU's text for how).
// Assumes: as there. CPU variant: a work-item takes a plane.
#include "tracking/fourier.cpu.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void spectra(
    __global const float* restrict planes, __global const float* restrict twiddles,
    __global float* restrict spectra, int cells, int count) {
  float re[MAX_PLANE];
  float im[MAX_PLANE];
  const int size = cells * cells;
  const size_t p = get_global_id(0);
  if (p >= (size_t)count) return;
  for (int i = 0; i < size; i += 16) {
    vstore16(vload16(0, planes + p * (size_t)size + i), 0, re + i);
    vstore16((float16)(0.0f), 0, im + i);
  }
  forward_plane(re, im, twiddles, cells);
  __global float* out = spectra + 2 * p * (size_t)size;
  for (int i = 0; i < size; i += 16) {
    vstore16(vload16(0, re + i), 0, out + i);
    vstore16(vload16(0, im + i), 0, out + size + i);
  }
}
