// Orientation and descriptor of every keypoint. The direction bin (0..31) is that of the intensity
// centroid of the circular patch of radius 15 in the level's image, by cross products with the
// bins' boundaries; it is written into the keypoint. Bit t of the descriptor compares two pixels of
// the blurred image: patch[table[bin][t].x] < patch[table[bin][t].y], with patch the 31 rows of 32
// pixels around the keypoint; bit t is bit t % 32 of word t / 32.
// Assumes: keypoints at least BORDER from the edges; width, height of level 0, level 1 follows from
// them; stride == width; table has 32 x 256 pairs of offsets below 31 * 32.
// 32 work-items per keypoint, four keypoints per group: a work-item sums one column of the patch,
// tests one direction bin, and makes one byte of the descriptor.
#include "frontend/common.clh"

#define LANES 32
#define PER_GROUP 4

__kernel __attribute__((reqd_work_group_size(LANES, PER_GROUP, 1))) void describe(
    __global const uchar* restrict image0, __global const uchar* restrict image1,
    __global const uchar* restrict blurred0, __global const uchar* restrict blurred1,
    __global int4* restrict keypoints, __global uint* restrict descriptors,
    __constant ushort2* restrict table, int width, int count) {
  __local uchar patches[PER_GROUP][PATCH_ROWS * PATCH_STRIDE];
  __local int2 moments[PER_GROUP][LANES];
  __local int bins[PER_GROUP];
  __local uint bytes[PER_GROUP][LANES];
  const int lane = (int)get_local_id(0);
  const int slot = (int)get_local_id(1);
  const int index = (int)get_global_id(1);
  const int used = index < count;

  int4 keypoint = (int4)(0);
  if (used) {
    keypoint = keypoints[index];
    const int level = level_of(keypoint);
    const int stride = level == 0 ? width : width * 5 / 6;
    const int corner =
        ((keypoint.z >> 16) - RADIUS) * stride + (keypoint.z & 0xFFFF) - RADIUS + lane;
    __global const uchar* sharp = (level == 0 ? image0 : image1) + corner;
    __global const uchar* soft = (level == 0 ? blurred0 : blurred1) + corner;
    const int dx = lane - RADIUS;
    const int reach = HALF_WIDTH[min((int)abs(dx), RADIUS)];
    int sum = 0;
    int weighted = 0;
    for (int row = 0; row < PATCH_ROWS; ++row) {
      const int dy = row - RADIUS;
      patches[slot][row * PATCH_STRIDE + lane] = soft[row * stride];
      const int inside = dx <= RADIUS && (int)abs(dy) <= reach;
      const int value = inside ? (int)sharp[row * stride] : 0;
      sum += value;
      weighted += dy * value;
    }
    moments[slot][lane] = (int2)(dx * sum, weighted);
  } else {
    moments[slot][lane] = (int2)(0);
  }
  if (lane == 0) bins[slot] = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int half_row = LANES / 2; half_row > 0; half_row /= 2) {
    if (lane < half_row) moments[slot][lane] += moments[slot][lane + half_row];
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  const int2 m = moments[slot][0];
  if (in_bin(lane, m.x, m.y)) bins[slot] = lane;
  barrier(CLK_LOCAL_MEM_FENCE);

  const int bin = bins[slot];
  uint bits = 0;
  if (used) {
    for (int t = 0; t < 8; ++t) {
      const ushort2 pair = table[bin * TESTS + lane * 8 + t];
      bits |= (patches[slot][pair.x] < patches[slot][pair.y] ? 1u : 0u) << t;
    }
  }
  bytes[slot][lane] = bits;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (!used) return;
  if (lane < 8) {
    descriptors[index * 8 + lane] = bytes[slot][4 * lane] | (bytes[slot][4 * lane + 1] << 8) |
                                    (bytes[slot][4 * lane + 2] << 16) |
                                    (bytes[slot][4 * lane + 3] << 24);
  }
  if (lane == 0) {
    keypoint.w = (keypoint.w & ~0xFF00) | (bin << 8);
    keypoints[index] = keypoint;
  }
}
