// 31 channels from the histograms (see the GPU's text for how).
// Assumes: as there; cells at most MAX_CELLS. FPGA variant: histograms are fetched into on-chip
// memory; energies and norms of a cell take a clock each; then channel by channel a feature leaves
// a clock. What is summed over the channels comes back to a cell only a plane later.
#include "common/fpga.clh"
#include "tracking/constants.clh"
#include "tracking/math.clh"

static inline float cut_off(float v) {
  return v < 0.2f ? v : 0.2f;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void cell_features(
    __global const int* restrict histograms, __global const float* restrict taper,
    __global float* restrict features, int cells, int count) {
  float bins[BINS][MAX_PLANE] PARTITION_COMPLETE(1);
  float norm[4][MAX_PLANE] PARTITION_COMPLETE(1);
  float texture[4][MAX_PLANE] PARTITION_COMPLETE(1);
  float energy[MAX_PLANE] PARTITION_CYCLIC(4, 1);
  float window[MAX_CELLS];
  const int plane = cells * cells;
  PIPELINE(1)
  for (int k = 0; k < cells; ++k) window[k] = taper[k];
  for (int p = 0; p < count; ++p) {
    __global const int* of_patch = histograms + (size_t)p * BINS * (size_t)plane;
    __global float* out = features + (size_t)p * CHANNELS * (size_t)plane;
    for (int o = 0; o < BINS; ++o) {
      PIPELINE(1)
      for (int cell = 0; cell < plane; ++cell) bins[o][cell] = (float)of_patch[o * plane + cell];
    }
    PIPELINE(1)
    for (int cell = 0; cell < plane; ++cell) {
      float sum = 0.0f;
      UNROLL(DIRECTIONS)
      for (int o = 0; o < DIRECTIONS; ++o) {
        const float both = bins[o][cell] + bins[o + DIRECTIONS][cell];
        sum = fma(both, both, sum);
      }
      energy[cell] = sum;
    }
    PIPELINE(1)
    for (int cell = 0; cell < plane; ++cell) {
      const int x = cell % cells;
      const int y = cell / cells;
      UNROLL(4)
      for (int k = 0; k < 4; ++k) {
        const int bx = clamp(x + (k & 1) * 2 - 1, 0, cells - 1);
        const int by = clamp(y + (k >> 1) * 2 - 1, 0, cells - 1) * cells;
        norm[k][cell] = reciprocal_root(
            ((energy[cell] + energy[y * cells + bx]) + (energy[by + x] + energy[by + bx])) +
            ENERGY_FLOOR);
      }
    }
    for (int o = 0; o < BINS; ++o) {
      PIPELINE(1)
      for (int cell = 0; cell < plane; ++cell) {
        float sum = 0.0f;
        UNROLL(4)
        for (int k = 0; k < 4; ++k) {
          const float cut = cut_off(bins[o][cell] * norm[k][cell]);
          sum = sum + cut;
          texture[k][cell] = (o == 0 ? 0.0f : texture[k][cell]) + cut;
        }
        out[o * plane + cell] = (0.5f * sum) * (window[cell / cells] * window[cell % cells]);
      }
    }
    for (int o = 0; o < DIRECTIONS; ++o) {
      PIPELINE(1)
      for (int cell = 0; cell < plane; ++cell) {
        const float both = bins[o][cell] + bins[o + DIRECTIONS][cell];
        float sum = 0.0f;
        UNROLL(4)
        for (int k = 0; k < 4; ++k) sum = sum + cut_off(both * norm[k][cell]);
        out[(BINS + o) * plane + cell] =
            (0.5f * sum) * (window[cell / cells] * window[cell % cells]);
      }
    }
    for (int k = 0; k < 4; ++k) {
      PIPELINE(1)
      for (int cell = 0; cell < plane; ++cell) {
        out[(BINS + DIRECTIONS + k) * plane + cell] =
            (0.2357f * texture[k][cell]) * (window[cell / cells] * window[cell % cells]);
      }
    }
  }
}
