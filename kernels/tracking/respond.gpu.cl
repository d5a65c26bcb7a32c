// A target's filter applied to its patches (Henriques et al., TPAMI 2015, equation 22): product of
// the spectra, back to shifts, and of the response the largest value, its place and its four
// cyclic neighbours: {value, place, left, right, above, below} per patch. Of equal values the first
// counts.
// Assumes: as correlate. GPU variant: a work-group takes a patch.
#include "tracking/fourier.gpu.clh"

__kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void respond(
    __global const float* restrict kernels, __global const float* restrict filters,
    __global const int* restrict slots, __global const float* restrict twiddles,
    __global float* restrict peaks, int cells, int scales, int count) {
  __local float re[MAX_PLANE];
  __local float im[MAX_PLANE];
  __local float largest[ITEMS];
  __local int places[ITEMS];
  const int p = (int)get_group_id(0);
  if (p >= count) return;  // the whole group
  const int item = (int)get_local_id(0);
  const int size = cells * cells;
  const size_t stride = 2 * (size_t)size;
  __global const float* kernel_of = kernels + (size_t)p * stride;
  __global const float* filter = filters + (size_t)slots[p / scales] * stride;
  for (int i = item; i < size; i += ITEMS) {
    const float kr = kernel_of[i];
    const float ki = kernel_of[i + size];
    const float ar = filter[i];
    const float ai = filter[i + size];
    re[at(i, cells)] = fma(kr, ar, -(ki * ai));
    im[at(i, cells)] = fma(kr, ai, ki * ar);
  }
  inverse_plane(re, im, twiddles, cells);
  int best = item;
  for (int i = item + ITEMS; i < size; i += ITEMS) best = re[i] > re[best] ? i : best;
  largest[item] = re[best];
  places[item] = best;
  for (int half_size = ITEMS / 2; half_size >= 1; half_size /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < half_size) {
      const float other = largest[item + half_size];
      const int place = places[item + half_size];
      if (other > largest[item] || (other == largest[item] && place < places[item])) {
        largest[item] = other;
        places[item] = place;
      }
    }
  }
  if (item != 0) return;
  const float over = 1.0f / (float)size;  // a power of two: exact
  const int place = places[0];
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
