// 31 channels from the histograms (Felzenszwalb et al., TPAMI 2010): signed and unsigned directions
// normalised by the energies of the four blocks of 2 x 2 cells around each cell, cut off at 0.2 and
// summed, and the four blocks' sums over all directions; times a window in both directions, so that
// the plane can be continued cyclically.
// Assumes: histograms below 2^23; cells a multiple of 8. Blocks at the edge repeat it. Floating
// point without contraction, every sum in the order of bins or blocks. GPU variant: a work-group
// takes 8 x 8 cells; their energies and their neighbours' lie in local memory.
#include "tracking/constants.clh"
#include "tracking/math.clh"

#define TILE 8
#define REACH (TILE + 2)

__kernel __attribute__((reqd_work_group_size(TILE, TILE, 1))) void cell_features(
    __global const int* restrict histograms, __global const float* restrict taper,
    __global float* restrict features, int cells, int count) {
  __local float energy[REACH * REACH];
  const int x = (int)get_global_id(0);
  const int y = (int)get_global_id(1);
  const int p = (int)get_global_id(2);
  if (p >= count) return;  // the whole group
  const size_t plane = (size_t)cells * (size_t)cells;
  __global const int* of_patch = histograms + (size_t)p * BINS * plane;
  const int item = (int)(get_local_id(1) * TILE + get_local_id(0));
  for (int k = item; k < REACH * REACH; k += TILE * TILE) {
    const int cx = clamp((int)get_group_id(0) * TILE - 1 + k % REACH, 0, cells - 1);
    const int cy = clamp((int)get_group_id(1) * TILE - 1 + k / REACH, 0, cells - 1);
    __global const int* bins = of_patch + cy * cells + cx;
    float sum = 0.0f;
    for (int o = 0; o < DIRECTIONS; ++o) {
      const float both =
          (float)bins[(size_t)o * plane] + (float)bins[(size_t)(o + DIRECTIONS) * plane];
      sum = fma(both, both, sum);
    }
    energy[k] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  __local const float* e = energy + ((int)get_local_id(1) + 1) * REACH + (int)get_local_id(0) + 1;
  float norm[4];
  for (int k = 0; k < 4; ++k) {
    const int bx = (k & 1) * 2 - 1;
    const int by = ((k >> 1) * 2 - 1) * REACH;
    norm[k] = reciprocal_root(((e[0] + e[bx]) + (e[by] + e[bx + by])) + ENERGY_FLOOR);
  }
  const float window = taper[y] * taper[x];
  __global const int* bins = of_patch + y * cells + x;
  __global float* out = features + (size_t)p * CHANNELS * plane + (size_t)(y * cells + x);
  float texture[4] = {0.0f, 0.0f, 0.0f, 0.0f};
  float signed_bin[BINS];
  for (int o = 0; o < BINS; ++o) {
    signed_bin[o] = (float)bins[(size_t)o * plane];
    float sum = 0.0f;
    for (int k = 0; k < 4; ++k) {
      const float scaled = signed_bin[o] * norm[k];
      const float cut = scaled < 0.2f ? scaled : 0.2f;
      sum = sum + cut;
      texture[k] = texture[k] + cut;
    }
    out[(size_t)o * plane] = (0.5f * sum) * window;
  }
  for (int o = 0; o < DIRECTIONS; ++o) {
    const float both = signed_bin[o] + signed_bin[o + DIRECTIONS];
    float sum = 0.0f;
    for (int k = 0; k < 4; ++k) {
      const float scaled = both * norm[k];
      sum = sum + (scaled < 0.2f ? scaled : 0.2f);
    }
    out[(size_t)(BINS + o) * plane] = (0.5f * sum) * window;
  }
  for (int k = 0; k < 4; ++k) {
    out[(size_t)(BINS + DIRECTIONS + k) * plane] = (0.2357f * texture[k]) * window;
  }
}
