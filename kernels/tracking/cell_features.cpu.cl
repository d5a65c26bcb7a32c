// 31 channels from the histograms (see the GPU's text for how).
// Assumes: as there; cells a multiple of 16, at most MAX_CELLS. CPU variant: a work-item takes a
// row of cells of a patch, 16 cells at a time.
#include "tracking/constants.clh"
#include "tracking/math16.clh"

static inline float16 bin_of(__global const int* bins, size_t plane, int o) {
  return convert_float16(vload16(0, bins + (size_t)o * plane));
}

static inline float16 cut_off(float16 v) {
  return v < 0.2f ? v : (float16)(0.2f);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void cell_features(
    __global const int* restrict histograms, __global const float* restrict taper,
    __global float* restrict features, int cells, int count) {
  float energy[3][MAX_CELLS + 2];  // of the row above, this one and the one below; edges repeat
  const int y = (int)get_global_id(0);
  const int p = (int)get_global_id(1);
  if (p >= count) return;
  const size_t plane = (size_t)cells * (size_t)cells;
  __global const int* of_patch = histograms + (size_t)p * BINS * plane;
  for (int r = 0; r < 3; ++r) {
    __global const int* row = of_patch + clamp(y + r - 1, 0, cells - 1) * cells;
    for (int x = 0; x < cells; x += 16) {
      float16 sum = (float16)(0.0f);
      for (int o = 0; o < DIRECTIONS; ++o) {
        const float16 both = bin_of(row + x, plane, o) + bin_of(row + x, plane, o + DIRECTIONS);
        sum = fma(both, both, sum);
      }
      vstore16(sum, 0, &energy[r][1 + x]);
    }
    energy[r][0] = energy[r][1];
    energy[r][cells + 1] = energy[r][cells];
  }
  for (int x = 0; x < cells; x += 16) {
    float16 norm[4];
    for (int k = 0; k < 4; ++k) {
      const int cx = 1 + x;
      const int bx = cx + (k & 1) * 2 - 1;
      const int by = (k >> 1) * 2;
      norm[k] = reciprocal_root16(((vload16(0, &energy[1][cx]) + vload16(0, &energy[1][bx])) +
                                   (vload16(0, &energy[by][cx]) + vload16(0, &energy[by][bx]))) +
                                  ENERGY_FLOOR);
    }
    const float16 window = taper[y] * vload16(0, taper + x);
    __global const int* bins = of_patch + y * cells + x;
    __global float* out = features + (size_t)p * CHANNELS * plane + (size_t)(y * cells + x);
    float16 texture[4] = {(float16)(0.0f), (float16)(0.0f), (float16)(0.0f), (float16)(0.0f)};
    for (int o = 0; o < BINS; ++o) {
      const float16 value = bin_of(bins, plane, o);
      float16 sum = (float16)(0.0f);
      for (int k = 0; k < 4; ++k) {
        const float16 cut = cut_off(value * norm[k]);
        sum = sum + cut;
        texture[k] = texture[k] + cut;
      }
      vstore16((0.5f * sum) * window, 0, out + (size_t)o * plane);
    }
    for (int o = 0; o < DIRECTIONS; ++o) {
      const float16 both = bin_of(bins, plane, o) + bin_of(bins, plane, o + DIRECTIONS);
      float16 sum = (float16)(0.0f);
      for (int k = 0; k < 4; ++k) sum = sum + cut_off(both * norm[k]);
      vstore16((0.5f * sum) * window, 0, out + (size_t)(BINS + o) * plane);
    }
    for (int k = 0; k < 4; ++k) {
      vstore16((0.2357f * texture[k]) * window, 0, out + (size_t)(BINS + DIRECTIONS + k) * plane);
    }
  }
}
