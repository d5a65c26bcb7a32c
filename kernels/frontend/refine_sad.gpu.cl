// Refines every unique match: the 11 x 11 patch around the query in image a is compared by the sum
// of absolute differences with image b around the partner, at offsets within +-range_x, +-range_y,
// in the level of both; the least sum (ties: the upper row, then the left column) is refined by a
// parabola in x, and in y if range_y > 0. Result: {x_q8, y_q8 in b, original coordinates; partner;
// sum}, or {0, 0, -1, 0} if the match is not unique, the least sum is above max_sad or lies at the
// search's edge. With same_row the search in b is centred on the query's row (rectified stereo),
// else on the partner's.
// Assumes: keypoints of a and b at least BORDER from the edges, partners of the same level;
// 1 <= range_x <= 8, 0 <= range_y <= 4; stride == width.
// 32 work-items per query, four queries per group: both patches in local memory, one offset per
// work-item at a time.
#include "frontend/refine.clh"

#define LANES 32
#define PER_GROUP 4
#define WINDOW_X (SAD_SIZE + 2 * MAX_RANGE_X)
#define WINDOW_Y (SAD_SIZE + 2 * MAX_RANGE_Y)

__kernel __attribute__((reqd_work_group_size(LANES, PER_GROUP, 1))) void refine_sad(
    __global const uchar* restrict a0, __global const uchar* restrict a1,
    __global const uchar* restrict b0, __global const uchar* restrict b1,
    __global const int4* restrict keypoints_a, __global const int4* restrict keypoints_b,
    __global const int2* restrict matches, __global const int2* restrict inverse,
    __global int4* restrict refined_matches, int width, int count, int range_x, int range_y,
    int same_row, int max_sad) {
  __local uchar patches[PER_GROUP][SAD_SIZE * SAD_SIZE];
  __local uchar windows[PER_GROUP][WINDOW_X * WINDOW_Y];
  __local int costs[PER_GROUP][MAX_POSITIONS];
  const int lane = (int)get_local_id(0);
  const int slot = (int)get_local_id(1);
  const int index = (int)get_global_id(1);
  const int across = 2 * range_x + 1;
  const int positions = across * (2 * range_y + 1);
  const int window_x = SAD_SIZE + 2 * range_x;
  const int window_y = SAD_SIZE + 2 * range_y;
  int other = -1;
  int level = 0;
  int x = 0;
  int y = 0;
  if (index < count) other = partner(matches, inverse, index);
  if (other >= 0) {
    const int4 a = keypoints_a[index];
    const int4 b = keypoints_b[other];
    level = level_of(a);
    const int stride = level == 0 ? width : width * 5 / 6;
    x = b.z & 0xFFFF;
    y = same_row ? a.z >> 16 : b.z >> 16;
    __global const uchar* patch = (level == 0 ? a0 : a1) + ((a.z >> 16) - SAD_RADIUS) * stride +
                                  (a.z & 0xFFFF) - SAD_RADIUS;
    __global const uchar* window =
        (level == 0 ? b0 : b1) + (y - SAD_RADIUS - range_y) * stride + x - SAD_RADIUS - range_x;
    for (int row = 0; row < SAD_SIZE && lane < SAD_SIZE; ++row) {
      patches[slot][row * SAD_SIZE + lane] = patch[row * stride + lane];
    }
    for (int row = 0; row < window_y && lane < window_x; ++row) {
      windows[slot][row * window_x + lane] = window[row * stride + lane];
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const int reciprocal = 65536 / across + 1;  // p / across, exact for p < 153
  for (int p = lane; p < positions && other >= 0; p += LANES) {
    const int row_of_p = (p * reciprocal) >> 16;
    __local const uchar* b =
        windows[slot] + row_of_p * (window_x - across) + p;
    int sum = 0;
    for (int row = 0; row < SAD_SIZE; ++row) {
      for (int column = 0; column < SAD_SIZE; ++column) {
        sum +=
            (int)abs((int)patches[slot][row * SAD_SIZE + column] - (int)b[row * window_x + column]);
      }
    }
    costs[slot][p] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (lane != 0 || index >= count) return;
  int4 result = REFUSED;
  if (other >= 0) {
    __local const int* c = costs[slot];
    int best = 0;
    for (int p = 1; p < positions; ++p) best = c[p] < c[best] ? p : best;
    const int best_row = (best * reciprocal) >> 16;
    const int west = best > 0 ? c[best - 1] : 0;
    const int east = best + 1 < positions ? c[best + 1] : 0;
    const int north = best >= across ? c[best - across] : 0;
    const int south = best + across < positions ? c[best + across] : 0;
    result = refined(x, y, level, other, best - best_row * across - range_x, best_row - range_y,
                     range_x, range_y, west, east, north, south, c[best], max_sad);
  }
  refined_matches[index] = result;
}
