// A target's new coefficients and model (see the GPU's text for how).
// Assumes: as there. FPGA variant: target by target; a number of the model is read and written a
// clock; of the filter two numbers come and go through each port, two clocks an entry.
#include "common/fpga.clh"
#include "tracking/constants.clh"
#include "tracking/math.clh"

static inline float moved(float old, float target, float rate) {
  return rate < 1.0f ? fma(rate, target - old, old) : target;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void train(
    __global const float* restrict kernels, __global const float* restrict spectra,
    __global const float* restrict label, __global const int* restrict slots,
    __global const float* restrict rates, __global float* restrict filters,
    __global float* restrict models, int cells, int count, float regularisation) {
  const int size = cells * cells;
  const int values = 2 * CHANNELS * size;
  for (int t = 0; t < count; ++t) {
    const int slot = slots[t];
    const float rate = rates[t];
    __global float* model = models + (size_t)slot * (size_t)values;
    __global const float* spectrum = spectra + (size_t)t * (size_t)values;
    PIPELINE(1)
    for (int i = 0; i < values; ++i) model[i] = moved(model[i], spectrum[i], rate);
    __global const float* kernel_of = kernels + (size_t)t * 2 * (size_t)size;
    __global float* filter = filters + (size_t)slot * 2 * (size_t)size;
    PIPELINE(2)
    for (int i = 0; i < size; ++i) {
      const float kr = kernel_of[i] + regularisation;
      const float ki = kernel_of[i + size];
      const float over = reciprocal(fma(ki, ki, kr * kr));
      const float yr = label[i];
      const float yi = label[i + size];
      filter[i] = moved(filter[i], fma(yi, ki, yr * kr) * over, rate);
      filter[i + size] = moved(filter[i + size], fma(yi, kr, -(yr * ki)) * over, rate);
    }
  }
}
