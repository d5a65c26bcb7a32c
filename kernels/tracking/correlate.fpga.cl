// The Gaussian kernel between each patch and its target's model (see the GPU's text for how).
// Assumes: as there. FPGA variant: patch by patch. The sums over the channels run plane by plane,
// so that an entry comes back only a plane later; its real and imaginary parts come through one
// port, two clocks an entry. Everything else takes an entry a clock.
#include "tracking/fourier.fpga.clh"

static inline float tree_sum(float* values, int size) {
  for (int half_size = size / 2; half_size >= 1; half_size /= 2) {
    PIPELINE(1)
    for (int i = 0; i < half_size; ++i) values[i] = values[i] + values[i + half_size];
  }
  return values[0];
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void correlate(
    __global const float* restrict models, __global const float* restrict spectra,
    __global const int* restrict slots, __global const float* restrict twiddles,
    __global float* restrict kernels, int cells, int scales, int count, float falloff) {
  float re[MAX_PLANE] PARTITION_CYCLIC(2, 1);
  float im[MAX_PLANE] PARTITION_CYCLIC(2, 1);
  float model_norm[MAX_PLANE];
  float patch_norm[MAX_PLANE];
  float table[MAX_CELLS];
  const int size = cells * cells;
  const size_t stride = 2 * (size_t)size;
  const float scale = falloff * (1.0f / (float)size);
  load_twiddles(table, twiddles, cells);
  for (int p = 0; p < count; ++p) {
    __global const float* model = models + (size_t)slots[p / scales] * CHANNELS * stride;
    __global const float* patch = spectra + (size_t)p * CHANNELS * stride;
    for (int c = 0; c < CHANNELS; ++c) {
      PIPELINE(2)
      for (int i = 0; i < size; ++i) {
        const int entry = at(i, cells);
        const float xr = model[(size_t)c * stride + (size_t)i];
        const float xi = model[(size_t)c * stride + (size_t)(i + size)];
        const float zr = patch[(size_t)c * stride + (size_t)i];
        const float zi = patch[(size_t)c * stride + (size_t)(i + size)];
        const bool first = c == 0;
        re[entry] = fma(xi, zi, fma(xr, zr, first ? 0.0f : re[entry]));
        im[entry] = fma(-xi, zr, fma(xr, zi, first ? 0.0f : im[entry]));
        model_norm[i] = fma(xi, xi, fma(xr, xr, first ? 0.0f : model_norm[i]));
        patch_norm[i] = fma(zi, zi, fma(zr, zr, first ? 0.0f : patch_norm[i]));
      }
    }
    const float norms = tree_sum(model_norm, size) + tree_sum(patch_norm, size);
    inverse_plane(re, im, table, cells);
    PIPELINE(1)
    for (int i = 0; i < size; ++i) {
      const float distance = fma(-2.0f, re[i], norms);
      re[i] = exp_of_minus((distance > 0.0f ? distance : 0.0f) * scale);
      im[i] = 0.0f;
    }
    forward_plane(re, im, table, cells);
    PIPELINE(1)
    for (int i = 0; i < 2 * size; ++i) {
      const int entry = at(i % size, cells);
      kernels[(size_t)p * stride + (size_t)i] = i < size ? re[entry] : im[entry];
    }
  }
}
