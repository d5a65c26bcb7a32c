// A target's new coefficients and model (see the GPU's text for how).
// Assumes: as there. CPU variant: a work-item takes a channel of a target, sixteen numbers at a
// time; that of the first channel does the filter as well.
#include "tracking/constants.clh"
#include "tracking/math16.clh"

static inline float16 moved(float16 old, float16 target, float rate) {
  return rate < 1.0f ? fma((float16)(rate), target - old, old) : target;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void train(
    __global const float* restrict kernels, __global const float* restrict spectra,
    __global const float* restrict label, __global const int* restrict slots,
    __global const float* restrict rates, __global float* restrict filters,
    __global float* restrict models, int cells, int count, float regularisation) {
  const int channel = (int)get_global_id(0);
  const int t = (int)get_global_id(1);
  if (t >= count) return;
  const int size = cells * cells;
  const size_t stride = 2 * (size_t)size;
  const int slot = slots[t];
  const float rate = rates[t];
  __global float* model = models + ((size_t)slot * CHANNELS + (size_t)channel) * stride;
  __global const float* spectrum = spectra + ((size_t)t * CHANNELS + (size_t)channel) * stride;
  for (int i = 0; i < 2 * size; i += 16) {
    vstore16(moved(vload16(0, model + i), vload16(0, spectrum + i), rate), 0, model + i);
  }
  if (channel > 0) return;
  __global const float* kernel_of = kernels + (size_t)t * stride;
  __global float* filter = filters + (size_t)slot * stride;
  for (int i = 0; i < size; i += 16) {
    const float16 kr = vload16(0, kernel_of + i) + regularisation;
    const float16 ki = vload16(0, kernel_of + size + i);
    const float16 over = reciprocal16(fma(ki, ki, kr * kr));
    const float16 yr = vload16(0, label + i);
    const float16 yi = vload16(0, label + size + i);
    vstore16(moved(vload16(0, filter + i), fma(yi, ki, yr * kr) * over, rate), 0, filter + i);
    vstore16(moved(vload16(0, filter + size + i), fma(yi, kr, -(yr * ki)) * over, rate), 0,
             filter + size + i);
  }
}
