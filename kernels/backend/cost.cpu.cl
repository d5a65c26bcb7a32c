// CC, CPU: the points' steps by back-substitution (a work-item per 64 points), then the robust cost
// of the trial state, a work-item per chunk, eight observations in a vector.
#include "backend/double8.clh"
#include "backend/layout.clh"
#include "backend/point.clh"
#include "backend/projection.clh"

// steps: DOF of every camera, filled up to 9 with zeros.
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(back_substitute)(
    __global const double* restrict eliminated, __global const double* restrict factors,
    __global const double* restrict blocks, __global const int* restrict point_start,
    __global const int* restrict point_slots, __global const int* restrict point_cameras,
    __global const double* restrict steps, __global const double* restrict point_scales,
    __global const double* restrict state, __global double* restrict trial,
    __global double* restrict sums, int points, double inverse_radius) {
  const int group = (int)get_global_id(0);
  const int end = min((group + 1) * GROUP_POINTS, points);
  double total[3] = {0, 0, 0};
  for (int point = group * GROUP_POINTS; point < end; ++point) {
    double8 t[3] = {(double8)(0), (double8)(0), (double8)(0)};
    double last[3] = {0, 0, 0};
    for (int i = point_start[point]; i < point_start[point + 1]; ++i) {
      __global const double* z = eliminated + (size_t)point_slots[i] * ELIMINATED_STRIDE;
      __global const double* step = steps + (size_t)point_cameras[i] * 9;
      const double8 s = vload8(0, step);
#pragma unroll
      for (int k = 0; k < 3; ++k) {
        t[k] = fma(vload8((size_t)k, z), s, t[k]);
        last[k] = fma(z[24 + k], step[8], last[k]);
      }
    }
    step_point(factors + (size_t)point * 9, sum8(t[0]) + last[0], sum8(t[1]) + last[1],
               sum8(t[2]) + last[2], blocks + (size_t)point * 9, point_scales + (size_t)point * 3,
               inverse_radius, state + (size_t)point * 3, trial + (size_t)point * 3, total);
  }
#pragma unroll
  for (int i = 0; i < 3; ++i) sums[group * 3 + i] = total[i];
}

inline __attribute__((always_inline)) double8 gather(__global const double* values, int8 i) {
  return (double8)(values[i.s0], values[i.s1], values[i.s2], values[i.s3], values[i.s4],
                   values[i.s5], values[i.s6], values[i.s7]);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(cost)(
    __global const double* restrict cameras, __global const double* restrict state,
    __global const int4* restrict chunks, __global const int* restrict slot_points,
    __global const double* restrict measured, __global const double* restrict weights,
    __global double* restrict costs, int slots, int chunk_count, int loss, double loss_scale) {
  const int chunk = (int)get_global_id(0);
  if (chunk >= chunk_count) return;
  const int4 at = chunks[chunk];
  __global const double* camera = cameras + (size_t)at.x * CAMERA_STRIDE;
  double8 sum = (double8)(0);
  for (int slot = at.y; slot < at.y + at.z; slot += 8) {
    const int8 first = vload8(0, slot_points + slot) * 3;
    const double8 x[3] = {gather(state, first), gather(state, first + 1), gather(state, first + 2)};
    double8 m[RESIDUALS];
    double8 r[RESIDUALS];
#pragma unroll
    for (int i = 0; i < RESIDUALS; ++i)
      m[i] = vload8(0, measured + (size_t)i * (size_t)slots + slot);
    project(camera, x, m, r);
    const double8 weight = vload8(0, weights + slot);
#pragma unroll
    for (int i = 0; i < RESIDUALS; ++i) r[i] = r[i] * weight;
    sum += loss_of(squared_norm(r), loss, loss_scale);
  }
  costs[chunk] = sum8(sum);
}
