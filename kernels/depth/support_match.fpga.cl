// Disparities of the support grid, FPGA variant.
// Assumes: 16-byte descriptors, row-major; pictures at least 2 MARGIN and at most FPGA_WIDTH wide;
// max_disparity <= 255. One work-item. For each row of the grid two rows of either view's
// descriptors enter on-chip memory once; then one disparity is weighed per clock (II = 1, four
// distances side by side), and the costs, kept on the chip, are passed once more for the second
// best.
#include "common/fpga.clh"
#include "depth/constants.clh"
#include "depth/distance_scalar.clh"

#define NEVER 0xffffffffu

// Rows v - 2 and v + 2 of a view.
typedef struct {
  uchar16 above[FPGA_WIDTH];
  uchar16 below[FPGA_WIDTH];
} Rows;

static inline void load_rows(__global const uchar* restrict view, int width, int v,
                             __private Rows* rows) {
  PIPELINE(2)
  for (int x = 0; x < width; ++x) {
    rows->above[x] = vload16((size_t)(v - 2) * (size_t)width + (size_t)x, view);
    rows->below[x] = vload16((size_t)(v + 2) * (size_t)width + (size_t)x, view);
  }
}

static inline int match(__private const Rows* own, __private const Rows* other, uchar16 here, int u,
                        int direction, int last, int texture, int ratio, int* distinct) {
  uint keys[DISPARITIES];
  const uchar16 a = own->above[u - 2];
  const uchar16 b = own->above[u + 2];
  const uchar16 c = own->below[u - 2];
  const uchar16 e = own->below[u + 2];
  uint best = NEVER;
  PIPELINE(1)
  for (int d = 0; d <= last; ++d) {
    const int x = u + direction * d;
    const int cost = distance16(a, other->above[x - 2]) + distance16(b, other->above[x + 2]) +
                     distance16(c, other->below[x - 2]) + distance16(e, other->below[x + 2]);
    keys[d] = ((uint)cost << 8) | (uint)d;
    best = min(best, keys[d]);
  }
  const int disparity = (int)(best & 255u);
  uint second = NEVER;
  PIPELINE(1)
  for (int d = 0; d <= last; ++d) {
    if (d < disparity - 1 || d > disparity + 1) second = min(second, keys[d]);
  }
  *distinct = texture16(here) >= texture && second != NEVER &&
              100u * (best >> 8) < (uint)ratio * (second >> 8);
  return disparity;
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void support_match(
    __global const uchar* restrict left, __global const uchar* restrict right,
    __global short* restrict grid, int width, int height, int step, int max_disparity, int texture,
    int ratio, int lr_threshold) {
  Rows left_rows;
  Rows right_rows;
  const int columns = (width + step - 1) / step;
  const int rows = (height + step - 1) / step;
  for (int row = 0; row < rows; ++row) {
    const int v = row * step;
    const bool inside = v >= MARGIN && v < height - MARGIN;
    if (inside) {
      load_rows(left, width, v, &left_rows);
      load_rows(right, width, v, &right_rows);
    }
    for (int i = 0; i < columns; ++i) {
      const int u = i * step;
      short found = -1;
      if (inside && u >= MARGIN && u < width - MARGIN) {
        int distinct = 0;
        int distinct_back = 0;
        const size_t middle = (size_t)v * (size_t)width + (size_t)u;
        const int d = match(&left_rows, &right_rows, vload16(middle, left), u, -1,
                            min(max_disparity, u - MARGIN), texture, ratio, &distinct);
        const int room = width - 1 - MARGIN - (u - d);
        const int back = match(&right_rows, &left_rows, vload16(middle - (size_t)d, right), u - d,
                               1, min(max_disparity, room), texture, ratio, &distinct_back);
        if (distinct != 0 && distinct_back != 0 && max(d, back) - min(d, back) <= lr_threshold) {
          found = (short)d;
        }
      }
      grid[(size_t)row * (size_t)columns + (size_t)i] = found;
    }
  }
}
