// SE in single precision, one work-item: points, then pairs of cameras. A pair's entries follow
// each other every fourth cycle; the block lies in registers, in fixed point.
#include "backend/float1.clh"
#include "backend/lanes.clh"
#include "backend/layout.clh"
#include "backend/point.clh"
#include "common/fpga.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(eliminate_points)(
    __global const float* restrict jacobians, __global const int* restrict point_start,
    __global const int* restrict point_slots, __global const float* restrict blocks,
    __global float* restrict factors, __global float* restrict eliminated, int points,
    float inverse_radius) {
  for (int point = 0; point < points; ++point) {
    const Factor f = factorise_point(blocks + (size_t)point * 9, inverse_radius);
    store_factor(f, factors + (size_t)point * 9);
    PIPELINE(4)
    for (int i = point_start[point]; i < point_start[point + 1]; ++i) {
      const size_t slot = (size_t)point_slots[i];
      eliminate_slot(jacobians + slot * JACOBIAN_STRIDE, f, eliminated + slot * ELIMINATED_STRIDE);
    }
  }
}

// The rows of Z' as DOF x 3, and y.
inline __attribute__((always_inline)) void load_columns(__global const float* record, float* z) {
  for (int k = 0; k < 3; ++k) {
    for (int c = 0; c < COLUMNS; ++c) z[k * DOF + c] = record[8 * k + c];
#if !STEREO
    z[k * DOF + 8] = record[24 + k];
#endif
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(schur_complement)(
    __global const float* restrict eliminated, __global const float* restrict partials,
    __global const int4* restrict pairs, __global const int2* restrict entries,
    __global const int* restrict camera_chunks, __global float* restrict blocks,
    __global float* restrict camera_sums, int pair_count) {
  for (int pair = 0; pair < pair_count; ++pair) {
    const int4 at = pairs[pair];
    const bool diagonal = at.z == at.w;
    long S[BLOCK] PARTITION_COMPLETE(1);
    long rhs[DOF] PARTITION_COMPLETE(1);
    for (int i = 0; i < BLOCK; ++i) S[i] = 0;
    for (int i = 0; i < DOF; ++i) rhs[i] = 0;
    __global float* sums = camera_sums + (size_t)at.z * (3 * DOF);
    if (diagonal) {
      for (int chunk = camera_chunks[at.z]; chunk < camera_chunks[at.z + 1]; ++chunk) {
        __global const float* part = partials + (size_t)chunk * PARTIAL;
        for (int i = 0; i < BLOCK; ++i) S[i] += to_fixed(part[i]);
        for (int i = 0; i < DOF; ++i) rhs[i] -= to_fixed(part[BLOCK + i]);
      }
      for (int i = 0; i < DOF; ++i) {
        sums[DOF + i] = -from_fixed(rhs[i]);
        sums[2 * DOF + i] = from_fixed(S[i * DOF + i]);
      }
    }
    PIPELINE(4)
    for (int entry = at.x; entry < at.y; ++entry) {
      const int2 slots = entries[entry];
      float zi[3 * DOF];
      float zj[3 * DOF];
      load_columns(eliminated + (size_t)slots.x * ELIMINATED_STRIDE, zi);
      load_columns(eliminated + (size_t)slots.y * ELIMINATED_STRIDE, zj);
      for (int r = 0; r < DOF; ++r) {
        for (int c = 0; c < DOF; ++c) {
          const float product =
              fma(zi[2 * DOF + r], zj[2 * DOF + c], fma(zi[DOF + r], zj[DOF + c], zi[r] * zj[c]));
          S[r * DOF + c] -= to_fixed(product);
        }
      }
      if (diagonal && slots.x == slots.y) {
        __global const float* y = eliminated + (size_t)slots.x * ELIMINATED_STRIDE + 27;
        for (int r = 0; r < DOF; ++r) {
          rhs[r] += to_fixed(fma(zi[2 * DOF + r], y[2], fma(zi[DOF + r], y[1], zi[r] * y[0])));
        }
      }
    }
    for (int i = 0; i < BLOCK; ++i) blocks[(size_t)pair * BLOCK + (size_t)i] = from_fixed(S[i]);
    if (diagonal) {
      for (int i = 0; i < DOF; ++i) sums[i] = from_fixed(rhs[i]);
    }
  }
}
