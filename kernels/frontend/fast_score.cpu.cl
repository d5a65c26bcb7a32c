// FAST-9 scores (see the GPU's text for what they are).
// Assumes: stride == width; 0 <= threshold <= 255; any size.
// One work-item per band of 16 rows. A row is one loop over bytes without a branch, of which the
// compiler makes full vectors: quicker than skipping, by shorter ones, what cannot be a corner.
#include "frontend/common.clh"
#include "frontend/fast.clh"

#define BAND 16

static inline void score_row(__global const uchar* row, __global uchar* out, int end, int width,
                             uchar threshold) {
#define AT(dx, dy) row[x + (dy)*width + (dx)]
  for (int x = 3; x < end; ++x) {
    const uchar c = row[x];
    uchar result;
    FAST9_SCORE(result, uchar, c, AT)
    out[x] = result > threshold ? result : (uchar)0;
  }
#undef AT
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void fast_score(
    __global const uchar* restrict src, __global uchar* restrict score, int width, int height,
    int threshold) {
  const int first = (int)get_global_id(0) * BAND;
  const int last = min(first + BAND, height);
  for (int y = first; y < last; ++y) {
    __global uchar* out = score + y * width;
    if (y < 3 || y >= height - 3 || width < 7) {
      for (int x = 0; x < width; ++x) out[x] = 0;
      continue;
    }
    for (int x = 0; x < 3; ++x) {
      out[x] = 0;
      out[width - 1 - x] = 0;
    }
    score_row(src + y * width, out, width - 3, width, (uchar)threshold);
  }
}
