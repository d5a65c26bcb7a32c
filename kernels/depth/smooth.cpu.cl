// Adaptive mean and median along rows or columns, CPU variant.
// Assumes: any size. One work-item takes a band of BAND rows, local size 1. 16 pixels go at a time,
// the last 16 of a row overlap their predecessors. Pixels too near to a line's end stay as they
// are.
#include "depth/smooth.clh"

// Disparities of 16 pixels' neighbours, `stride` apart.
static inline ushort16 mean16(__global const ushort* p, int stride) {
  const ushort16 here = vload16(0, p);
  const int16 middle = convert_int16(here);
  int16 weights = (int16)(0);
  int16 sum = (int16)(0);
  for (int k = -MEAN_REACH; k <= MEAN_REACH; ++k) {
    const int16 tap = convert_int16(vload16(0, p + k * stride));
    const int16 off = tap - middle;
    const int16 weight = max((int16)(FARTHEST)-max(off, -off), (int16)(0)) & (tap != (int16)(0));
    weights += weight;
    sum += weight * off;
  }
  // Both are below 2^24 and exact as floats, so that the quotient is off by less than one.
  const int16 divisor = max(weights + weights, (int16)(1));
  const int16 numerator = sum + sum + weights;
  int16 quotient = convert_int16(convert_float16(numerator) / convert_float16(divisor));
  quotient += (quotient * divisor > numerator);
  quotient -= ((quotient + (int16)(1)) * divisor <= numerator);
  return convert_ushort16((middle + quotient) & (middle != (int16)(0)));
}

#define ORDER16(a, b)                 \
  do {                                \
    const ushort16 least = min(a, b); \
    b = max(a, b);                    \
    a = least;                        \
  } while (0)

static inline ushort16 median16(__global const ushort* p, int stride) {
  const ushort16 here = vload16(0, p);
  ushort16 a = vload16(0, p - 3 * stride), b = vload16(0, p - 2 * stride),
           c = vload16(0, p - stride), d = here, e = vload16(0, p + stride),
           f = vload16(0, p + 2 * stride), g = vload16(0, p + 3 * stride);
  // clang-format off
  ORDER16(a, f); ORDER16(a, d); ORDER16(b, g); ORDER16(c, e); ORDER16(a, b); ORDER16(d, f);
  ORDER16(c, g); ORDER16(c, d); ORDER16(d, g); ORDER16(e, f); ORDER16(b, e); ORDER16(b, d);
  ORDER16(d, e);
  // clang-format on
  return d & as_ushort16(here != (ushort16)(0));
}

static inline ushort adaptive_mean_pixel(__global const ushort* p, int stride) {
  ushort taps[2 * MEAN_REACH + 1];
  for (int k = 0; k < 2 * MEAN_REACH + 1; ++k) taps[k] = p[(k - MEAN_REACH) * stride];
  return mean_of(taps);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void adaptive_mean(
    __global const ushort* restrict map, __global ushort* restrict out, int width, int height,
    int vertical) {
  const int stride = vertical != 0 ? width : 1;
  const int first = vertical != 0 ? 0 : min(MEAN_REACH, width);
  const int last = vertical != 0 ? width : max(width - MEAN_REACH, first);
  const int top = (int)get_global_id(0) * BAND;
  for (int y = top; y < min(top + BAND, height); ++y) {
    __global const ushort* row = map + (size_t)y * (size_t)width;
    __global ushort* to = out + (size_t)y * (size_t)width;
    if (vertical != 0 && (y < MEAN_REACH || y >= height - MEAN_REACH)) {
      for (int x = 0; x < width; ++x) to[x] = row[x];
      continue;
    }
    for (int x = 0; x < first; ++x) to[x] = row[x];
    for (int x = last; x < width; ++x) to[x] = row[x];
    if (last - first < 16) {
      for (int x = first; x < last; ++x) to[x] = adaptive_mean_pixel(row + x, stride);
      continue;
    }
    for (int x = first; x < last; x += 16) {
      const int from = min(x, last - 16);
      vstore16(mean16(row + from, stride), 0, to + from);
    }
  }
}

static inline ushort median_pixel(__global const ushort* p, int stride) {
  ushort taps[2 * MEDIAN_REACH + 1];
  for (int k = 0; k < 2 * MEDIAN_REACH + 1; ++k) taps[k] = p[(k - MEDIAN_REACH) * stride];
  return median_of(taps);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void median(
    __global const ushort* restrict map, __global ushort* restrict out, int width, int height,
    int vertical) {
  const int stride = vertical != 0 ? width : 1;
  const int first = vertical != 0 ? 0 : min(MEDIAN_REACH, width);
  const int last = vertical != 0 ? width : max(width - MEDIAN_REACH, first);
  const int top = (int)get_global_id(0) * BAND;
  for (int y = top; y < min(top + BAND, height); ++y) {
    __global const ushort* row = map + (size_t)y * (size_t)width;
    __global ushort* to = out + (size_t)y * (size_t)width;
    if (vertical != 0 && (y < MEDIAN_REACH || y >= height - MEDIAN_REACH)) {
      for (int x = 0; x < width; ++x) to[x] = row[x];
      continue;
    }
    for (int x = 0; x < first; ++x) to[x] = row[x];
    for (int x = last; x < width; ++x) to[x] = row[x];
    if (last - first < 16) {
      for (int x = first; x < last; ++x) to[x] = median_pixel(row + x, stride);
      continue;
    }
    for (int x = first; x < last; x += 16) {
      const int from = min(x, last - 16);
      vstore16(median16(row + from, stride), 0, to + from);
    }
  }
}
