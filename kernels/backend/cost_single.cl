// CC in single precision, one work-item: back-substitution over the points, then the cost chunk by
// chunk in eight lanes, which also hide an adder's latency.
#include "backend/float1.clh"
#include "backend/lanes.clh"
#include "backend/layout.clh"
#include "backend/point.clh"
#include "backend/projection.clh"
#include "common/fpga.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(back_substitute)(
    __global const float* restrict eliminated, __global const float* restrict factors,
    __global const float* restrict blocks, __global const int* restrict point_start,
    __global const int* restrict point_slots, __global const int* restrict point_cameras,
    __global const float* restrict steps, __global const float* restrict point_scales,
    __global const float* restrict state, __global float* restrict trial,
    __global float* restrict sums, int points, float inverse_radius) {
  for (int group = 0; group * GROUP_POINTS < points; ++group) {
    const int end = min((group + 1) * GROUP_POINTS, points);
    float total[3] = {0, 0, 0};
    for (int point = group * GROUP_POINTS; point < end; ++point) {
      float lanes[24];
      float last[3] = {0, 0, 0};
      for (int i = 0; i < 24; ++i) lanes[i] = 0;
      PIPELINE(4)
      for (int i = point_start[point]; i < point_start[point + 1]; ++i) {
        add_step(eliminated + (size_t)point_slots[i] * ELIMINATED_STRIDE,
                 steps + (size_t)point_cameras[i] * 9, lanes, last);
      }
      step_point(factors + (size_t)point * 9, sum_lanes(lanes) + last[0],
                 sum_lanes(lanes + 8) + last[1], sum_lanes(lanes + 16) + last[2],
                 blocks + (size_t)point * 9, point_scales + (size_t)point * 3, inverse_radius,
                 state + (size_t)point * 3, trial + (size_t)point * 3, total);
    }
    for (int i = 0; i < 3; ++i) sums[group * 3 + i] = total[i];
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(cost)(
    __global const float* restrict cameras, __global const float* restrict state,
    __global const int4* restrict chunks, __global const int* restrict slot_points,
    __global const float* restrict measured, __global const float* restrict weights,
    __global float* restrict costs, int slots, int chunk_count, int loss, float loss_scale) {
  for (int chunk = 0; chunk < chunk_count; ++chunk) {
    const int4 at = chunks[chunk];
    float lanes[8] PARTITION_COMPLETE(1) = {0, 0, 0, 0, 0, 0, 0, 0};
    PIPELINE(1)
    for (int i = 0; i < at.z; ++i) {
      const size_t slot = (size_t)(at.y + i);
      const size_t first = (size_t)slot_points[slot] * 3;
      const float x[3] = {state[first], state[first + 1], state[first + 2]};
      float m[RESIDUALS];
      float r[RESIDUALS];
      for (int k = 0; k < RESIDUALS; ++k) m[k] = measured[(size_t)k * (size_t)slots + slot];
      project(cameras + (size_t)at.x * CAMERA_STRIDE, x, m, r);
      for (int k = 0; k < RESIDUALS; ++k) r[k] = r[k] * weights[slot];
      lanes[i % 8] += loss_of(squared_norm(r), loss, loss_scale);
    }
    costs[chunk] = sum_lanes(lanes);
  }
}
