// Orientation and descriptor of every keypoint (see the GPU's text for what they are).
// Assumes: as there.
// The table is copied on chip once, 32 bytes per cycle. Per keypoint: 31 cycles fetch a row of the
// patch from both images (32 bytes each) and add it to the moments; one step finds the bin by 32
// comparisons side by side; 32 cycles make a byte of the descriptor each, from a patch that is kept
// in eight copies with two ports, so that sixteen pixels can be read at once. Nothing but the sums
// is carried from one iteration to the next: II = 1 in each loop.
#include "common/fpga.clh"
#include "frontend/common.clh"

#define COPIES 8

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void describe(
    __global const uchar* restrict image0, __global const uchar* restrict image1,
    __global const uchar* restrict blurred0, __global const uchar* restrict blurred1,
    __global int4* restrict keypoints, __global uint* restrict descriptors,
    __constant ushort2* restrict table, int width, int count) {
  ushort2 tests[BINS * TESTS] PARTITION_CYCLIC(COPIES, 1);
  uchar patch[COPIES][PATCH_ROWS * PATCH_STRIDE] PARTITION_COMPLETE(1);
  PIPELINE(1)
  for (int i = 0; i < BINS * TESTS; i += COPIES) {
    UNROLL(COPIES)
    for (int k = 0; k < COPIES; ++k) tests[i + k] = table[i + k];
  }
  for (int index = 0; index < count; ++index) {
    int4 keypoint = keypoints[index];
    const int level = level_of(keypoint);
    const int stride = level == 0 ? width : width * 5 / 6;
    const int corner = ((keypoint.z >> 16) - RADIUS) * stride + (keypoint.z & 0xFFFF) - RADIUS;
    __global const uchar* sharp = (level == 0 ? image0 : image1) + corner;
    __global const uchar* soft = (level == 0 ? blurred0 : blurred1) + corner;
    int m10 = 0;
    int m01 = 0;
    PIPELINE(1)
    for (int row = 0; row < PATCH_ROWS; ++row) {
      const int dy = row - RADIUS;
      const int reach = HALF_WIDTH[abs(dy)];
      int sum = 0;
      int weighted = 0;
      UNROLL(PATCH_STRIDE)
      for (int column = 0; column < PATCH_STRIDE; ++column) {
        const int dx = column - RADIUS;
        const int value = (int)abs(dx) <= reach ? (int)sharp[row * stride + column] : 0;
        sum += value;
        weighted += dx * value;
        const uchar blurred = soft[row * stride + column];
        UNROLL(COPIES)
        for (int k = 0; k < COPIES; ++k) patch[k][row * PATCH_STRIDE + column] = blurred;
      }
      m10 += weighted;
      m01 += dy * sum;
    }
    int bin = 0;
    UNROLL(BINS)
    for (int b = 0; b < BINS; ++b) bin = in_bin(b, m10, m01) ? b : bin;
    uint words[8] PARTITION_COMPLETE(0);
    UNROLL(8)
    for (int i = 0; i < 8; ++i) words[i] = 0;
    PIPELINE(1)
    for (int i = 0; i < TESTS / COPIES; ++i) {
      uint bits = 0;
      UNROLL(COPIES)
      for (int k = 0; k < COPIES; ++k) {
        const ushort2 pair = tests[bin * TESTS + i * COPIES + k];
        bits |= (patch[k][pair.x] < patch[k][pair.y] ? 1u : 0u) << k;
      }
      words[i / 4] |= bits << (i % 4 * 8);
    }
    UNROLL(8)
    for (int i = 0; i < 8; ++i) descriptors[index * 8 + i] = words[i];
    keypoint.w = (keypoint.w & ~0xFF00) | (bin << 8);
    keypoints[index] = keypoint;
  }
}
