// Histograms of gradient directions over cells (see the GPU's text for how).
// Assumes: as there; side at most MAX_SIDE. FPGA variant: a patch is fetched into on-chip memory,
// then cell by cell its 64 pixels vote, one a clock, into 18 registers; sums of integers take one
// clock, so nothing that is carried from one pixel to the next is late.
#include "common/fpga.clh"
#include "tracking/direction.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void cell_histograms(
    __global const ushort* restrict patches, __global int* restrict histograms, int cells,
    int count) {
  ushort patch[MAX_SIDE * MAX_SIDE] PARTITION_CYCLIC(4, 1);
  const int side = CELL * cells;
  const int plane = cells * cells;
  for (int p = 0; p < count; ++p) {
    const size_t first = (size_t)p * (size_t)side * (size_t)side;
    PIPELINE(1)
    for (int k = 0; k < side * side; ++k) patch[k] = patches[first + (size_t)k];
    for (int cell = 0; cell < plane; ++cell) {
      int bins[BINS] PARTITION_COMPLETE(1);
      UNROLL(BINS)
      for (int b = 0; b < BINS; ++b) bins[b] = 0;
      const int left = CELL * (cell % cells) - 2;
      const int top = CELL * (cell / cells) - 2;
      PIPELINE(1)
      for (int k = 0; k < 64; ++k) {
        const int x = left + (k & 7);
        const int y = top + (k >> 3);
        if (x >= 0 && y >= 0 && x < side && y < side) {
          const int vote =
              vote_of(patch[y * side + min(x + 1, side - 1)] - patch[y * side + max(x - 1, 0)],
                      patch[min(y + 1, side - 1) * side + x] - patch[max(y - 1, 0) * side + x]);
          bins[vote & 31] += (vote >> 5) * weight_of(k & 7) * weight_of(k >> 3);
        }
      }
      PIPELINE(1)
      for (int b = 0; b < BINS; ++b) {
        histograms[((size_t)p * BINS + (size_t)b) * (size_t)plane + (size_t)cell] = bins[b];
      }
    }
  }
}
