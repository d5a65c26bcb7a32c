// Sobel gradients and descriptors, CPU variant.
// Assumes: pictures without row padding; any size from 1 x 1; one work-item takes a band of BAND
// rows, local size 1. Inside a row 16 pixels go at a time, the last 16 overlap their predecessors;
// columns at the border, and rows narrower than one step, go one by one with repeated edges.
#include "depth/constants.clh"

static inline short16 widen(__global const uchar* p) {
  return convert_short16(vload16(0, p));
}

static inline uchar16 squeeze16(short16 response) {
  return convert_uchar16(clamp((short16)(128) + (response >> 2), (short16)(0), (short16)(255)));
}

static inline uchar squeeze(int response) {
  return (uchar)clamp(128 + (response >> 2), 0, 255);
}

static inline void sobel_pixel(__global const uchar* above, __global const uchar* here,
                               __global const uchar* below, int x, int width, __global uchar* du,
                               __global uchar* dv) {
  const int l = max(x - 1, 0);
  const int r = min(x + 1, width - 1);
  const int first = above[l];
  const int third = above[r];
  const int seventh = below[l];
  const int ninth = below[r];
  du[x] = squeeze(third + 2 * here[r] + ninth - first - 2 * here[l] - seventh);
  dv[x] = squeeze(seventh + 2 * below[x] + ninth - first - 2 * above[x] - third);
}

static inline void sobel_step(__global const uchar* above, __global const uchar* here,
                              __global const uchar* below, int x, __global uchar* du,
                              __global uchar* dv) {
  const short16 first = widen(above + x - 1);
  const short16 third = widen(above + x + 1);
  const short16 seventh = widen(below + x - 1);
  const short16 ninth = widen(below + x + 1);
  const short16 sides = (widen(here + x + 1) - widen(here + x - 1)) * (short16)(2);
  const short16 ends = (widen(below + x) - widen(above + x)) * (short16)(2);
  vstore16(squeeze16(third + ninth - first - seventh + sides), 0, du + x);
  vstore16(squeeze16(seventh + ninth - first - third + ends), 0, dv + x);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void sobel(
    __global const uchar* restrict image, __global uchar* restrict du, __global uchar* restrict dv,
    int width, int height) {
  const int begin = (int)get_global_id(0) * BAND;
  for (int y = begin; y < min(begin + BAND, height); ++y) {
    __global const uchar* above = image + (size_t)max(y - 1, 0) * (size_t)width;
    __global const uchar* here = image + (size_t)y * (size_t)width;
    __global const uchar* below = image + (size_t)min(y + 1, height - 1) * (size_t)width;
    __global uchar* du_row = du + (size_t)y * (size_t)width;
    __global uchar* dv_row = dv + (size_t)y * (size_t)width;
    if (width < 18) {
      for (int x = 0; x < width; ++x) sobel_pixel(above, here, below, x, width, du_row, dv_row);
      continue;
    }
    sobel_pixel(above, here, below, 0, width, du_row, dv_row);
    for (int x = 1; x < width - 1; x += 16) {
      sobel_step(above, here, below, min(x, width - 17), du_row, dv_row);
    }
    sobel_pixel(above, here, below, width - 1, width, du_row, dv_row);
  }
}

// The rows y-2 .. y+2 of du (repeated at the edge) as distances from row y.
typedef struct {
  __global const uchar* restrict du0;
  __global const uchar* restrict du1;
  __global const uchar* restrict du2;
  __global const uchar* restrict du3;
  __global const uchar* restrict du4;
  __global const uchar* restrict dv1;
  __global const uchar* restrict dv2;
  __global const uchar* restrict dv3;
} Rows;

static inline uchar16 descriptor_pixel(const Rows rows, int x, int width) {
  const int l = max(x - 1, 0);
  const int r = min(x + 1, width - 1);
  return (uchar16)(rows.du0[l], rows.du0[r], rows.du1[l], rows.du1[x], rows.du1[r], rows.du2[l],
                   rows.du2[r], rows.du3[l], rows.du3[x], rows.du3[r], rows.du4[l], rows.du4[r],
                   rows.dv1[x], rows.dv2[l], rows.dv2[r], rows.dv3[x]);
}

// Turns 16 samples of 16 pixels into 16 pixels of 16 samples, as one transposes a matrix by halves:
// each step exchanges blocks of 1, 2, 4 and 8 bytes between rows that lie as far apart.
#define SWAP(word, bits, low, x, y)           \
  do {                                        \
    const word p = as_##word(x);              \
    const word q = as_##word(y);              \
    x = as_uchar16((p & low) | (q << bits));  \
    y = as_uchar16((p >> bits) | (q & ~low)); \
  } while (0)
#define SWAP1(x, y) SWAP(ushort8, (ushort8)(8), (ushort8)(0xff), x, y)
#define SWAP2(x, y) SWAP(uint4, (uint4)(16), (uint4)(0xffffu), x, y)
#define SWAP4(x, y) SWAP(ulong2, (ulong2)(32), (ulong2)(0xfffffffful), x, y)
#define SWAP8(x, y)                       \
  do {                                    \
    const ulong2 p = as_ulong2(x);        \
    const ulong2 q = as_ulong2(y);        \
    x = as_uchar16((ulong2)(p.s0, q.s0)); \
    y = as_uchar16((ulong2)(p.s1, q.s1)); \
  } while (0)
#define STORE(k) vstore16(a##k, k, out)

static inline void descriptor_step(const Rows rows, int x, __global uchar* out) {
  uchar16 a0 = vload16(0, rows.du0 + x - 1), a1 = vload16(0, rows.du0 + x + 1),
          a2 = vload16(0, rows.du1 + x - 1), a3 = vload16(0, rows.du1 + x),
          a4 = vload16(0, rows.du1 + x + 1), a5 = vload16(0, rows.du2 + x - 1),
          a6 = vload16(0, rows.du2 + x + 1), a7 = vload16(0, rows.du3 + x - 1),
          a8 = vload16(0, rows.du3 + x), a9 = vload16(0, rows.du3 + x + 1),
          a10 = vload16(0, rows.du4 + x - 1), a11 = vload16(0, rows.du4 + x + 1),
          a12 = vload16(0, rows.dv1 + x), a13 = vload16(0, rows.dv2 + x - 1),
          a14 = vload16(0, rows.dv2 + x + 1), a15 = vload16(0, rows.dv3 + x);
  // clang-format off
  SWAP1(a0, a1); SWAP1(a2, a3); SWAP1(a4, a5); SWAP1(a6, a7);
  SWAP1(a8, a9); SWAP1(a10, a11); SWAP1(a12, a13); SWAP1(a14, a15);
  SWAP2(a0, a2); SWAP2(a1, a3); SWAP2(a4, a6); SWAP2(a5, a7);
  SWAP2(a8, a10); SWAP2(a9, a11); SWAP2(a12, a14); SWAP2(a13, a15);
  SWAP4(a0, a4); SWAP4(a1, a5); SWAP4(a2, a6); SWAP4(a3, a7);
  SWAP4(a8, a12); SWAP4(a9, a13); SWAP4(a10, a14); SWAP4(a11, a15);
  SWAP8(a0, a8); SWAP8(a1, a9); SWAP8(a2, a10); SWAP8(a3, a11);
  SWAP8(a4, a12); SWAP8(a5, a13); SWAP8(a6, a14); SWAP8(a7, a15);
  STORE(0); STORE(1); STORE(2); STORE(3); STORE(4); STORE(5); STORE(6); STORE(7);
  STORE(8); STORE(9); STORE(10); STORE(11); STORE(12); STORE(13); STORE(14); STORE(15);
  // clang-format on
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void descriptor(
    __global const uchar* restrict du, __global const uchar* restrict dv,
    __global uchar* restrict descriptors, int width, int height) {
  const int begin = (int)get_global_id(0) * BAND;
  for (int y = begin; y < min(begin + BAND, height); ++y) {
    const size_t y0 = (size_t)max(y - 2, 0) * (size_t)width;
    const size_t y1 = (size_t)max(y - 1, 0) * (size_t)width;
    const size_t y2 = (size_t)y * (size_t)width;
    const size_t y3 = (size_t)min(y + 1, height - 1) * (size_t)width;
    const size_t y4 = (size_t)min(y + 2, height - 1) * (size_t)width;
    const Rows rows = {du + y0, du + y1, du + y2, du + y3, du + y4, dv + y1, dv + y2, dv + y3};
    __global uchar* out = descriptors + y2 * 16;
    if (width < 18) {
      for (int x = 0; x < width; ++x) vstore16(descriptor_pixel(rows, x, width), (size_t)x, out);
      continue;
    }
    for (int x = 1; x < width - 1; x += 16) {
      const int start = min(x, width - 17);
      descriptor_step(rows, start, out + start * 16);
    }
    vstore16(descriptor_pixel(rows, 0, width), 0, out);
    vstore16(descriptor_pixel(rows, width - 1, width), (size_t)(width - 1), out);
  }
}
