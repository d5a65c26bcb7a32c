// A target's filter applied to its patches (see the GPU's text for how).
// Assumes: as there. CPU variant: a work-item takes a patch, sixteen entries of its plane at a
// time.
#include "tracking/fourier.cpu.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void respond(
    __global const float* restrict kernels, __global const float* restrict filters,
    __global const int* restrict slots, __global const float* restrict twiddles,
    __global float* restrict peaks, int cells, int scales, int count) {
  float re[MAX_PLANE];
  float im[MAX_PLANE];
  const int p = (int)get_global_id(0);
  if (p >= count) return;
  const int size = cells * cells;
  const size_t stride = 2 * (size_t)size;
  __global const float* kernel_of = kernels + (size_t)p * stride;
  __global const float* filter = filters + (size_t)slots[p / scales] * stride;
  for (int i = 0; i < size; i += 16) {
    const float16 kr = vload16(0, kernel_of + i);
    const float16 ki = vload16(0, kernel_of + size + i);
    const float16 ar = vload16(0, filter + i);
    const float16 ai = vload16(0, filter + size + i);
    vstore16(fma(kr, ar, -(ki * ai)), 0, re + i);
    vstore16(fma(kr, ai, ki * ar), 0, im + i);
  }
  inverse_plane(re, im, twiddles, cells);
  int place = 0;
  for (int i = 1; i < size; ++i) place = re[i] > re[place] ? i : place;
  const float over = 1.0f / (float)size;  // a power of two: exact
  const int row = place - place % cells;
  const int column = place - row;
  __global float* peak = peaks + p * PEAK_ENTRIES;
  peak[0] = re[place] * over;
  peak[1] = (float)place;
  peak[2] = re[row + (column + cells - 1) % cells] * over;
  peak[3] = re[row + (column + 1) % cells] * over;
  peak[4] = re[(place + size - cells) % size] * over;
  peak[5] = re[(place + cells) % size] * over;
}
