// CC, GPU: a work-item per point, whose sums the group's first adds in order; then a work-group per
// chunk, a work-item per slot, summed in the CPU variant's order.
#include "backend/double1.clh"
#include "backend/lanes.clh"
#include "backend/layout.clh"
#include "backend/point.clh"
#include "backend/projection.clh"

__kernel __attribute__((reqd_work_group_size(GROUP_POINTS, 1, 1))) void MODEL(back_substitute)(
    __global const double* restrict eliminated, __global const double* restrict factors,
    __global const double* restrict blocks, __global const int* restrict point_start,
    __global const int* restrict point_slots, __global const int* restrict point_cameras,
    __global const double* restrict steps, __global const double* restrict point_scales,
    __global const double* restrict state, __global double* restrict trial,
    __global double* restrict sums, int points, double inverse_radius) {
  __local double step[GROUP_POINTS * 3];  // damping and gradient's share of a coordinate's
  __local double change[GROUP_POINTS * 3];
  const int point = (int)get_global_id(0);
  const int item = (int)get_local_id(0);
  if (point < points) {
    double lanes[24];
    double last[3] = {0, 0, 0};
    for (int i = 0; i < 24; ++i) lanes[i] = 0;
    for (int i = point_start[point]; i < point_start[point + 1]; ++i) {
      add_step(eliminated + (size_t)point_slots[i] * ELIMINATED_STRIDE,
               steps + (size_t)point_cameras[i] * 9, lanes, last);
    }
    const size_t at = (size_t)point;
    real d[3];
    point_direction(factors + at * 9, sum_lanes(lanes) + last[0], sum_lanes(lanes + 8) + last[1],
                    sum_lanes(lanes + 16) + last[2], d);
    for (int k = 0; k < 3; ++k) {
      step[item * 3 + k] = d[k];
      change[item * 3 + k] = d[k] * point_scales[at * 3 + (size_t)k];
      trial[at * 3 + (size_t)k] = state[at * 3 + (size_t)k] + change[item * 3 + k];
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item < 3) {
    const int first = (int)get_group_id(0) * GROUP_POINTS;
    const int count = min(GROUP_POINTS, points - first);
    double sum = 0;
    for (int i = 0; i < count * 3; ++i) {
      const size_t at = (size_t)(first * 3 + i);
      if (item == 0) {
        sum =
            model_share(blocks + (size_t)(first + i / 3) * 9, i % 3, step[i], inverse_radius, sum);
      } else {
        const double value = item == 1 ? change[i] : state[at];
        sum = fma(value, value, sum);
      }
    }
    sums[get_group_id(0) * 3 + (size_t)item] = sum;
  }
}

__kernel __attribute__((reqd_work_group_size(CHUNK, 1, 1))) void MODEL(cost)(
    __global const double* restrict cameras, __global const double* restrict state,
    __global const int4* restrict chunks, __global const int* restrict slot_points,
    __global const double* restrict measured, __global const double* restrict weights,
    __global double* restrict costs, int slots, int chunk_count, int loss, double loss_scale) {
  __local double shares[CHUNK];
  const int chunk = (int)get_group_id(0);
  const int item = (int)get_local_id(0);
  const int4 at = chunk < chunk_count ? chunks[chunk] : (int4)(0);
  if (item < at.z) {
    const size_t slot = (size_t)(at.y + item);
    const size_t first = (size_t)slot_points[slot] * 3;
    const double x[3] = {state[first], state[first + 1], state[first + 2]};
    double m[RESIDUALS];
    double r[RESIDUALS];
    for (int i = 0; i < RESIDUALS; ++i) m[i] = measured[(size_t)i * (size_t)slots + slot];
    project(cameras + (size_t)at.x * CAMERA_STRIDE, x, m, r);
    for (int i = 0; i < RESIDUALS; ++i) r[i] = r[i] * weights[slot];
    shares[item] = loss_of(squared_norm(r), loss, loss_scale);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0 && chunk < chunk_count) {
    double lanes[8] = {0, 0, 0, 0, 0, 0, 0, 0};
    for (int i = 0; i < at.z; ++i) lanes[i % 8] += shares[i];
    costs[chunk] = sum_lanes(lanes);
  }
}
