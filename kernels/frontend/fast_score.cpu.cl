// FAST-9 scores (see the GPU's text for what they are).
// Assumes: stride == width; 0 <= threshold <= 255; any size.
// One work-item per band of 16 rows, sixteen pixels at a time; a row's last vector overlaps the one
// before. Vectors without two neighbouring cardinal points beyond the threshold hold no corner: an
// arc of nine contains at least two of the four.
#include "frontend/common.clh"
#include "frontend/fast.clh"

#define BAND 16

static inline int any_set(uchar16 v) {
  const ulong2 words = as_ulong2(v);
  return (words.x | words.y) != 0;
}

static inline uchar16 score_of_vector(__global const uchar* p, int width, uchar16 threshold) {
  const uchar16 c = vload16(0, p);
#define AT(dx, dy) vload16(0, p + (dy) * width + (dx))
  const uchar16 north = AT(0, -3), east = AT(3, 0), south = AT(0, 3), west = AT(-3, 0);
  const uchar16 brighter = min(max(north, south), max(east, west));
  const uchar16 darker = max(min(north, south), min(east, west));
  const uchar16 possible = max(max(brighter, c) - c, c - min(darker, c));
  if (!any_set(max(possible, threshold) - threshold)) return (uchar16)(0);
  uchar16 result;
  FAST9_SCORE(result, uchar16, c, AT)
#undef AT
  return select((uchar16)(0), result, result > threshold);
}

static inline uchar score_of_pixel(__global const uchar* p, int width, int threshold) {
  const int c = p[0];
  int result;
#define AT(dx, dy) ((int)p[(dy) * width + (dx)])
  FAST9_SCORE(result, int, c, AT)
#undef AT
  return result > threshold ? (uchar)result : (uchar)0;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void fast_score(
    __global const uchar* restrict src, __global uchar* restrict score, int width, int height,
    int threshold) {
  const int first = (int)get_global_id(0) * BAND;
  const int last = min(first + BAND, height);
  const uchar16 bound = (uchar16)((uchar)threshold);
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
    __global const uchar* row = src + y * width;
    const int end = width - 3;
    if (end - 3 < 16) {
      for (int x = 3; x < end; ++x) out[x] = score_of_pixel(row + x, width, threshold);
      continue;
    }
    for (int x = 3; x < end; x += 16) {
      const int at = min(x, end - 16);
      vstore16(score_of_vector(row + at, width, bound), 0, out + at);
    }
  }
}
