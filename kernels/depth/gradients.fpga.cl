// Sobel gradients and descriptors, FPGA variant.
// Assumes: pictures without row padding, at most FPGA_WIDTH wide. One work-item streams the picture
// once: line buffers hold the rows above, a window of registers moves along the row, one pixel
// enters and one leaves per clock (II = 1). Rows and columns behind the last one repeat it.
#include "common/fpga.clh"
#include "depth/constants.clh"

static inline uchar squeeze(int response) {
  return (uchar)clamp(128 + (response >> 2), 0, 255);
}

// A column of the Sobel window.
typedef struct {
  int top, middle, bottom;
} Three;

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void sobel(
    __global const uchar* restrict image, __global uchar* restrict du, __global uchar* restrict dv,
    int width, int height) {
  uchar line[2][FPGA_WIDTH] PARTITION_COMPLETE(1);
  for (int r = 0; r <= height; ++r) {
    __global const uchar* incoming = image + (size_t)min(r, height - 1) * (size_t)width;
    Three a = {0, 0, 0};
    Three b = a;
    Three c = a;  // a, b, c: columns from left to right
    PIPELINE(1)
    for (int i = 0; i <= width; ++i) {
      a = b;
      b = c;
      if (i < width) {
        const uchar below = incoming[i];
        const uchar here = r == 0 ? below : line[1][i];
        c.top = r == 0 ? below : line[0][i];
        c.middle = here;
        c.bottom = below;
        line[0][i] = here;
        line[1][i] = below;
      }
      if (i == 0) b = c;
      if (r > 0 && i > 0) {
        const size_t out = (size_t)(r - 1) * (size_t)width + (size_t)(i - 1);
        du[out] = squeeze(c.top + 2 * c.middle + c.bottom - a.top - 2 * a.middle - a.bottom);
        dv[out] = squeeze(a.bottom + 2 * b.bottom + c.bottom - a.top - 2 * b.top - c.top);
      }
    }
  }
}

// A column of the window: rows y-2 .. y+2 of du, and of dv the three in the middle.
typedef struct {
  uchar u0, u1, u2, u3, u4;
  uchar v1, v2, v3;
} Column;

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void descriptor(
    __global const uchar* restrict du, __global const uchar* restrict dv,
    __global uchar* restrict descriptors, int width, int height) {
  uchar u_line[4][FPGA_WIDTH] PARTITION_COMPLETE(1);
  uchar v_line[4][FPGA_WIDTH] PARTITION_COMPLETE(1);
  for (int r = 0; r < height + 2; ++r) {
    const size_t row = (size_t)min(r, height - 1) * (size_t)width;
    Column b = {0, 0, 0, 0, 0, 0, 0, 0};
    Column x = b;
    Column c = b;  // b, x, c: columns from left to right
    PIPELINE(1)
    for (int i = 0; i < width + 1; ++i) {
      b = x;
      x = c;
      if (i < width) {
        const uchar u = du[row + (size_t)i];
        const uchar v = dv[row + (size_t)i];
        const bool first = r == 0;
        c.u0 = first ? u : u_line[0][i];
        c.u1 = first ? u : u_line[1][i];
        c.u2 = first ? u : u_line[2][i];
        c.u3 = first ? u : u_line[3][i];
        c.u4 = u;
        c.v1 = first ? v : v_line[1][i];
        c.v2 = first ? v : v_line[2][i];
        c.v3 = first ? v : v_line[3][i];
        u_line[0][i] = c.u1;
        u_line[1][i] = c.u2;
        u_line[2][i] = c.u3;
        u_line[3][i] = u;
        v_line[1][i] = c.v2;
        v_line[2][i] = c.v3;
        v_line[3][i] = v;
      }
      if (i == 0) x = c;
      if (r > 1 && i > 0) {
        const uchar16 samples = (uchar16)(b.u0, c.u0, b.u1, x.u1, c.u1, b.u2, c.u2, b.u3, x.u3,
                                          c.u3, b.u4, c.u4, x.v1, b.v2, c.v2, x.v3);
        vstore16(samples, (size_t)(r - 2) * (size_t)width + (size_t)(i - 1), descriptors);
      }
    }
  }
}
