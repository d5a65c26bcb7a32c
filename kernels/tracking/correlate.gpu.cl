// The Gaussian kernel between each patch and its target's model, for all shifts at once (Henriques,
// Caseiro, Martins, Batista, "High-Speed Tracking with Kernelized Correlation Filters", TPAMI 2015,
// equation 31): products of the spectra summed over the channels, back to shifts,
// exp(-(|x|^2 + |z|^2 - 2 x*z) falloff), and forth to a spectrum again.
// Assumes: spectra as the spectra kernel leaves them, cells 16 or 32. Patches of a target follow
// each other, `scales` of them; target t's model lies in slot slots[t] of `models`. Chains of fma
// over the channels, sums over a plane by halves. GPU variant: a work-group takes a patch.
#include "tracking/fourier.gpu.clh"

// Adds halves onto halves; the sum is in values[0], all items see it.
ALWAYS_INLINE void tree_sum(__local float* values, int size) {
  for (int half_size = size / 2; half_size >= 1; half_size /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int i = (int)get_local_id(0); i < half_size; i += ITEMS) {
      values[i] = values[i] + values[i + half_size];
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

__kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void correlate(
    __global const float* restrict models, __global const float* restrict spectra,
    __global const int* restrict slots, __global const float* restrict twiddles,
    __global float* restrict kernels, int cells, int scales, int count, float falloff) {
  __local float re[MAX_PLANE];
  __local float im[MAX_PLANE];
  __local float model_norm[MAX_PLANE];
  __local float patch_norm[MAX_PLANE];
  const int p = (int)get_group_id(0);
  if (p >= count) return;  // the whole group
  const int size = cells * cells;
  const size_t stride = 2 * (size_t)size;
  __global const float* model = models + (size_t)slots[p / scales] * CHANNELS * stride;
  __global const float* patch = spectra + (size_t)p * CHANNELS * stride;
  for (int i = (int)get_local_id(0); i < size; i += ITEMS) {
    float sum_re = 0.0f;
    float sum_im = 0.0f;
    float sum_x = 0.0f;
    float sum_z = 0.0f;
    for (int c = 0; c < CHANNELS; ++c) {
      __global const float* x = model + (size_t)c * stride + (size_t)i;
      __global const float* z = patch + (size_t)c * stride + (size_t)i;
      const float xr = x[0];
      const float xi = x[size];
      const float zr = z[0];
      const float zi = z[size];
      sum_re = fma(xi, zi, fma(xr, zr, sum_re));
      sum_im = fma(-xi, zr, fma(xr, zi, sum_im));
      sum_x = fma(xi, xi, fma(xr, xr, sum_x));
      sum_z = fma(zi, zi, fma(zr, zr, sum_z));
    }
    const int entry = at(i, cells);
    re[entry] = sum_re;
    im[entry] = sum_im;
    model_norm[i] = sum_x;
    patch_norm[i] = sum_z;
  }
  tree_sum(model_norm, size);
  tree_sum(patch_norm, size);
  const float norms = model_norm[0] + patch_norm[0];
  inverse_plane(re, im, twiddles, cells);
  // Spectra are not divided by anything: norms and products carry the plane's size once more.
  const float scale = falloff * (1.0f / (float)size);
  for (int i = (int)get_local_id(0); i < size; i += ITEMS) {
    const float distance = fma(-2.0f, re[i], norms);
    re[i] = exp_of_minus((distance > 0.0f ? distance : 0.0f) * scale);
    im[i] = 0.0f;
  }
  forward_plane(re, im, twiddles, cells);
  __global float* out = kernels + (size_t)p * stride;
  for (int i = (int)get_local_id(0); i < size; i += ITEMS) {
    out[i] = re[at(i, cells)];
    out[i + size] = im[at(i, cells)];
  }
}
