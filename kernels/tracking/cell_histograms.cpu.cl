// Histograms of gradient directions over cells (see the GPU's text for how).
// Assumes: as there; cells a multiple of 16, at most MAX_CELLS. CPU variant: a work-item takes a
// row of cells of a patch, that is eight rows of pixels; the votes of 16 pixels are found at a
// time.
#include "tracking/direction.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void cell_histograms(
    __global const ushort* restrict patches, __global int* restrict histograms, int cells,
    int count) {
  // A column of cells more on either side takes the votes that fall beside the patch.
  int bins[BINS][MAX_CELLS + 2];
  int row[MAX_SIDE + 32];
  int lengths[16], directions[16];
  const int cosines[DIRECTIONS] = COSINES;
  const int sines[DIRECTIONS] = SINES;
  const int weights[8] = WEIGHTS;
  const int side = CELL * cells;
  const int cy = (int)get_global_id(0);
  const int p = (int)get_global_id(1);
  if (p >= count) return;
  __global const ushort* patch = patches + (size_t)p * (size_t)side * (size_t)side;
  for (int b = 0; b < BINS; ++b) {
    for (int cx = 0; cx < cells + 2; ++cx) bins[b][cx] = 0;
  }
  for (int v = 0; v < 8; ++v) {
    const int y = CELL * cy - 2 + v;
    if (y < 0 || y >= side) continue;
    __global const ushort* above = patch + max(y - 1, 0) * side;
    __global const ushort* here = patch + y * side;
    __global const ushort* below = patch + min(y + 1, side - 1) * side;
    for (int x = 0; x < side; x += 16)
      vstore16(convert_int16(vload16(0, here + x)), 0, row + 1 + x);
    row[0] = row[1];
    row[side + 1] = row[side];
    for (int x = 0; x < side; x += 16) {
      const int16 dx = vload16(0, row + x + 2) - vload16(0, row + x);
      const int16 dy = convert_int16(vload16(0, below + x)) - convert_int16(vload16(0, above + x));
      int16 longest = (int16)(0);
      int16 bin = (int16)(0);
      for (int o = 0; o < DIRECTIONS; ++o) {
        const int16 along = dx * cosines[o] + dy * sines[o];
        const int16 length = max(along, -along);
        const int16 backwards = along < 0 ? (int16)(DIRECTIONS) : (int16)(0);
        bin = length > longest ? o + backwards : bin;
        longest = max(length, longest);
      }
      vstore16((longest >> 7) * weights[v], 0, lengths);
      vstore16(bin, 0, directions);
      // Pixel x lies between the cells (x - 2) / 4 and the next; in `bins` they are one further on.
      for (int k = 0; k < 16; ++k) {
        const int u = (x + k + 2) & 3;
        const int cx = (x + k + 2) >> 2;
        bins[directions[k]][cx + 1] += lengths[k] * weights[u];
        bins[directions[k]][cx] += lengths[k] * weights[u + 4];
      }
    }
  }
  const size_t plane = (size_t)cells * (size_t)cells;
  __global int* out = histograms + (size_t)p * BINS * plane + (size_t)cy * (size_t)cells;
  for (int b = 0; b < BINS; ++b) {
    for (int cx = 0; cx < cells; ++cx) out[(size_t)b * plane + (size_t)cx] = bins[b][cx + 1];
  }
}
