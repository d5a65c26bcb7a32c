// Refines every unique match (see the GPU's text for how).
// Assumes: as there.
// Per match: the rows of both patches are fetched, one row per cycle; then one offset per cycle,
// with all 121 differences and their adder tree side by side, from patches held in registers.
// Carried from one offset to the next is the least sum so far: II = 1.
#include "common/fpga.clh"
#include "frontend/refine.clh"

#define WINDOW_X (SAD_SIZE + 2 * MAX_RANGE_X)
#define WINDOW_Y (SAD_SIZE + 2 * MAX_RANGE_Y)

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void refine_sad(
    __global const uchar* restrict a0, __global const uchar* restrict a1,
    __global const uchar* restrict b0, __global const uchar* restrict b1,
    __global const int4* restrict keypoints_a, __global const int4* restrict keypoints_b,
    __global const int2* restrict matches, __global const int2* restrict inverse,
    __global int4* restrict refined_matches, int width, int count, int range_x, int range_y,
    int same_row, int max_sad) {
  uchar patch[SAD_SIZE][SAD_SIZE] PARTITION_COMPLETE(0);
  uchar window[WINDOW_Y][WINDOW_X] PARTITION_COMPLETE(0);
  int costs[MAX_POSITIONS];
  const int across = 2 * range_x + 1;
  const int positions = across * (2 * range_y + 1);
  for (int index = 0; index < count; ++index) {
    const int other = partner(matches, inverse, index);
    int4 result = REFUSED;
    if (other >= 0) {
      const int4 a = keypoints_a[index];
      const int4 b = keypoints_b[other];
      const int level = level_of(a);
      const int stride = level == 0 ? width : width * 5 / 6;
      const int x = b.z & 0xFFFF;
      const int y = same_row ? a.z >> 16 : b.z >> 16;
      __global const uchar* from_a = (level == 0 ? a0 : a1) + ((a.z >> 16) - SAD_RADIUS) * stride +
                                     (a.z & 0xFFFF) - SAD_RADIUS;
      __global const uchar* from_b = (level == 0 ? b0 : b1) + (y - SAD_RADIUS - range_y) * stride +
                                     x - SAD_RADIUS - range_x;
      PIPELINE(1)
      for (int row = 0; row < SAD_SIZE + 2 * range_y; ++row) {
        UNROLL(SAD_SIZE)
        for (int i = 0; i < SAD_SIZE; ++i) {
          if (row < SAD_SIZE) patch[row][i] = from_a[row * stride + i];
        }
        UNROLL(WINDOW_X)
        for (int i = 0; i < WINDOW_X; ++i) {
          if (i < SAD_SIZE + 2 * range_x) window[row][i] = from_b[row * stride + i];
        }
      }
      int best = 0;
      int best_x = 0;
      int best_y = 0;
      int least = 0x7FFFFFFF;
      int bx = 0;
      int by = 0;
      PIPELINE(1)
      for (int p = 0; p < positions; ++p) {
        int sum = 0;
        UNROLL(SAD_SIZE)
        for (int row = 0; row < SAD_SIZE; ++row) {
          UNROLL(SAD_SIZE)
          for (int i = 0; i < SAD_SIZE; ++i) {
            sum += (int)abs((int)patch[row][i] - (int)window[by + row][bx + i]);
          }
        }
        costs[p] = sum;
        if (sum < least) {
          best = p;
          best_x = bx - range_x;
          best_y = by - range_y;
        }
        least = min(least, sum);
        ++bx;
        if (bx == across) {
          bx = 0;
          ++by;
        }
      }
      const int west = best > 0 ? costs[best - 1] : 0;
      const int east = best + 1 < positions ? costs[best + 1] : 0;
      const int north = best >= across ? costs[best - across] : 0;
      const int south = best + across < positions ? costs[best + across] : 0;
      result = refined(x, y, level, other, best_x, best_y, range_x, range_y, west, east, north,
                       south, least, max_sad);
    }
    refined_matches[index] = result;
  }
}
