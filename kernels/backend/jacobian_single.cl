// JU in single precision, one work-item. Assumptions as in jacobian.cpu.cl. A slot enters every
// fourth cycle (a fourth of its multipliers then exist side by side); sums are fixed-point, so that
// nothing carried from slot to slot takes longer.
#include "backend/float1.clh"
#include "backend/lanes.clh"
#include "backend/layout.clh"
#include "backend/point.clh"
#include "backend/projection.clh"
#include "common/fpga.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(jacobian_update)(
    __global const float* restrict cameras, __global const float* restrict state,
    __global const float* restrict point_scales, __global const int4* restrict chunks,
    __global const int* restrict slot_points, __global const float* restrict measured,
    __global const float* restrict weights, __global float* restrict jacobians,
    __global float* restrict partials, int slots, int chunk_count, int loss, float loss_scale) {
  for (int chunk = 0; chunk < chunk_count; ++chunk) {
    const int4 at = chunks[chunk];
    long sums[PARTIAL] PARTITION_COMPLETE(1);
    for (int i = 0; i < PARTIAL; ++i) sums[i] = 0;
    PIPELINE(4)
    for (int i = 0; i < at.z; ++i) {
      const size_t slot = (size_t)(at.y + i);
      const size_t first = (size_t)slot_points[slot] * 3;
      const float x[3] = {state[first], state[first + 1], state[first + 2]};
      const float scale[3] = {point_scales[first], point_scales[first + 1],
                              point_scales[first + 2]};
      float m[RESIDUALS];
      for (int k = 0; k < RESIDUALS; ++k) m[k] = measured[(size_t)k * (size_t)slots + slot];
      float r[RESIDUALS];
      float jc[RESIDUALS * DOF];
      float jp[RESIDUALS * 3];
      linearise(cameras + (size_t)at.x * CAMERA_STRIDE, x, scale, m, weights[slot], loss,
                loss_scale, r, jc, jp);
      store_record(r, jc, jp, jacobians + slot * JACOBIAN_STRIDE);
      for (int k = 0; k < RESIDUALS; ++k) {
        for (int a = 0; a < DOF; ++a) {
          for (int b = a; b < DOF; ++b)
            sums[a * DOF + b] += to_fixed(jc[k * DOF + a] * jc[k * DOF + b]);
          sums[BLOCK + a] += to_fixed(jc[k * DOF + a] * r[k]);
        }
      }
    }
    __global float* out = partials + (size_t)chunk * PARTIAL;
    for (int a = 0; a < DOF; ++a) {
      for (int b = 0; b < DOF; ++b)
        out[a * DOF + b] = from_fixed(sums[min(a, b) * DOF + max(a, b)]);
      out[BLOCK + a] = from_fixed(sums[BLOCK + a]);
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(point_update)(
    __global const float* restrict jacobians, __global const int* restrict point_start,
    __global const int* restrict point_slots, __global const float* restrict point_scales,
    __global float* restrict blocks, __global float* restrict gradients, int points) {
  for (int group = 0; group * GROUP_POINTS < points; ++group) {
    const int end = min((group + 1) * GROUP_POINTS, points);
    float largest = 0;
    for (int point = group * GROUP_POINTS; point < end; ++point) {
      largest = fmax(largest,
                     point_block(jacobians, point_start, point_slots, point_scales, blocks, point));
    }
    gradients[group] = largest;
  }
}
