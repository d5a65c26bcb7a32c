// Histograms of gradient directions over cells of 4 x 4 pixels (Felzenszwalb, Girshick, McAllester,
// Ramanan, "Object Detection with Discriminatively Trained Part-Based Models", TPAMI 2010): each
// pixel votes for one of 18 directions, bilinearly for the cells around it, with the length of its
// gradient's projection on that direction. Integers: any order of summation gives the same.
// Assumes: patches of grey levels with four fractional bits, so that a histogram stays below 2^23;
// cells a multiple of 8. GPU variant: a work-group takes 8 x 8 cells of a patch; the votes of its
// pixels lie in local memory.
#include "tracking/direction.clh"

#define TILE 8
#define REACH (CELL * TILE + 4)  // pixels across, with those that cells at the edge share

__kernel __attribute__((reqd_work_group_size(TILE, TILE, 1))) void cell_histograms(
    __global const ushort* restrict patches, __global int* restrict histograms, int cells,
    int count) {
  __local int votes[REACH * REACH];
  __local int bins[BINS * TILE * TILE];
  const int side = CELL * cells;
  const int item = (int)(get_local_id(1) * TILE + get_local_id(0));
  const int p = (int)get_global_id(2);
  if (p >= count) return;  // the whole group
  const int left = (int)get_group_id(0) * CELL * TILE - 2;
  const int top = (int)get_group_id(1) * CELL * TILE - 2;
  __global const ushort* patch = patches + (size_t)p * (size_t)side * (size_t)side;
  for (int k = item; k < REACH * REACH; k += TILE * TILE) {
    const int x = left + k % REACH;
    const int y = top + k / REACH;
    int vote = 0;
    if (x >= 0 && y >= 0 && x < side && y < side) {
      vote = vote_of(patch[y * side + min(x + 1, side - 1)] - patch[y * side + max(x - 1, 0)],
                     patch[min(y + 1, side - 1) * side + x] - patch[max(y - 1, 0) * side + x]);
    }
    votes[k] = vote;
  }
  for (int b = 0; b < BINS; ++b) bins[b * TILE * TILE + item] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int v = 0; v < 8; ++v) {
    for (int u = 0; u < 8; ++u) {
      const int vote =
          votes[((int)get_local_id(1) * CELL + v) * REACH + (int)get_local_id(0) * CELL + u];
      bins[(vote & 31) * TILE * TILE + item] += (vote >> 5) * weight_of(u) * weight_of(v);
    }
  }
  const int plane = cells * cells;
  const int cell = (int)get_global_id(1) * cells + (int)get_global_id(0);
  for (int b = 0; b < BINS; ++b) {
    histograms[((size_t)p * BINS + (size_t)b) * (size_t)plane + (size_t)cell] =
        bins[b * TILE * TILE + item];
  }
}
