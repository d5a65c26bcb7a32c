// A target's new coefficients (Henriques et al., TPAMI 2015, equation 17), label / (kernel +
// regularisation), and its model and coefficients moved towards the new ones by the target's rate;
// a rate of 1 replaces what was there, whatever it was.
// Assumes: spectra as the spectra kernel leaves them, cells 16 or 32; target t's filter and model
// lie in slot slots[t], and no two targets have the same. GPU variant: a work-item per number of a
// model, targets along y; those of the first plane do the filter as well.
#include "tracking/constants.clh"
#include "tracking/math.clh"

static inline float moved(float old, float target, float rate) {
  return rate < 1.0f ? fma(rate, target - old, old) : target;
}

__kernel __attribute__((reqd_work_group_size(128, 1, 1))) void train(
    __global const float* restrict kernels, __global const float* restrict spectra,
    __global const float* restrict label, __global const int* restrict slots,
    __global const float* restrict rates, __global float* restrict filters,
    __global float* restrict models, int cells, int count, float regularisation) {
  const int i = (int)get_global_id(0);
  const int t = (int)get_global_id(1);
  if (t >= count) return;
  const int size = cells * cells;
  const int values = 2 * CHANNELS * size;
  const int slot = slots[t];
  const float rate = rates[t];
  __global float* model = models + (size_t)slot * (size_t)values;
  model[i] = moved(model[i], spectra[(size_t)t * (size_t)values + (size_t)i], rate);
  if (i >= size) return;
  __global const float* kernel_of = kernels + (size_t)t * 2 * (size_t)size;
  __global float* filter = filters + (size_t)slot * 2 * (size_t)size;
  const float kr = kernel_of[i] + regularisation;
  const float ki = kernel_of[i + size];
  const float over = reciprocal(fma(ki, ki, kr * kr));
  const float yr = label[i];
  const float yi = label[i + size];
  filter[i] = moved(filter[i], fma(yi, ki, yr * kr) * over, rate);
  filter[i + size] = moved(filter[i + size], fma(yi, kr, -(yr * ki)) * over, rate);
}
