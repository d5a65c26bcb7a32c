// The Gaussian kernel between each patch and its target's model (see the GPU's text for how).
// Assumes: as there. CPU variant: a work-item takes a patch, sixteen entries of its plane at a
// time.
#include "tracking/fourier.cpu.clh"

// Adds halves onto halves.
static inline float tree_sum(float* values, int size) {
  int half_size = size / 2;
  for (; half_size >= 16; half_size /= 2) {
    for (int i = 0; i < half_size; i += 16) {
      vstore16(vload16(0, values + i) + vload16(0, values + i + half_size), 0, values + i);
    }
  }
  for (; half_size >= 1; half_size /= 2) {
    for (int i = 0; i < half_size; ++i) values[i] = values[i] + values[i + half_size];
  }
  return values[0];
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void correlate(
    __global const float* restrict models, __global const float* restrict spectra,
    __global const int* restrict slots, __global const float* restrict twiddles,
    __global float* restrict kernels, int cells, int scales, int count, float falloff) {
  float re[MAX_PLANE];
  float im[MAX_PLANE];
  float model_norm[MAX_PLANE];
  float patch_norm[MAX_PLANE];
  const int p = (int)get_global_id(0);
  if (p >= count) return;
  const int size = cells * cells;
  const size_t stride = 2 * (size_t)size;
  __global const float* model = models + (size_t)slots[p / scales] * CHANNELS * stride;
  __global const float* patch = spectra + (size_t)p * CHANNELS * stride;
  for (int i = 0; i < size; i += 16) {
    float16 sum_re = (float16)(0.0f);
    float16 sum_im = (float16)(0.0f);
    float16 sum_x = (float16)(0.0f);
    float16 sum_z = (float16)(0.0f);
    for (int c = 0; c < CHANNELS; ++c) {
      __global const float* x = model + (size_t)c * stride + (size_t)i;
      __global const float* z = patch + (size_t)c * stride + (size_t)i;
      const float16 xr = vload16(0, x);
      const float16 xi = vload16(0, x + size);
      const float16 zr = vload16(0, z);
      const float16 zi = vload16(0, z + size);
      sum_re = fma(xi, zi, fma(xr, zr, sum_re));
      sum_im = fma(-xi, zr, fma(xr, zi, sum_im));
      sum_x = fma(xi, xi, fma(xr, xr, sum_x));
      sum_z = fma(zi, zi, fma(zr, zr, sum_z));
    }
    vstore16(sum_re, 0, re + i);
    vstore16(sum_im, 0, im + i);
    vstore16(sum_x, 0, model_norm + i);
    vstore16(sum_z, 0, patch_norm + i);
  }
  const float norms = tree_sum(model_norm, size) + tree_sum(patch_norm, size);
  inverse_plane(re, im, twiddles, cells);
  const float scale = falloff * (1.0f / (float)size);
  for (int i = 0; i < size; i += 16) {
    const float16 distance = fma((float16)(-2.0f), vload16(0, re + i), (float16)(norms));
    const float16 held = distance > 0.0f ? distance : (float16)(0.0f);
    vstore16(exp_of_minus16(held * scale), 0, re + i);
    vstore16((float16)(0.0f), 0, im + i);
  }
  forward_plane(re, im, twiddles, cells);
  __global float* out = kernels + (size_t)p * stride;
  for (int i = 0; i < size; i += 16) {
    vstore16(vload16(0, re + i), 0, out + i);
    vstore16(vload16(0, im + i), 0, out + size + i);
  }
}
