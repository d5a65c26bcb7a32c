// JU, CPU: Jacobians and normal equations of cameras, a work-item per chunk, eight observations in
// a vector; then the points' blocks, a work-item per 64 points. Assumes chunk sizes and first slots
// that are multiples of 8, and points and cameras that exist.
#include "backend/double8.clh"
#include "backend/layout.clh"
#include "backend/point.clh"
#include "backend/projection.clh"

inline __attribute__((always_inline)) double8 gather(__global const double* values, int8 i) {
  return (double8)(values[i.s0], values[i.s1], values[i.s2], values[i.s3], values[i.s4],
                   values[i.s5], values[i.s6], values[i.s7]);
}

inline __attribute__((always_inline)) void store_records(double8* r, double8* jc, double8* jp,
                                                         __global double* out) {
  double8 record[JACOBIAN_STRIDE];
#pragma unroll
  for (int i = 0; i < JACOBIAN_STRIDE; ++i) record[i] = (double8)(0);
#pragma unroll
  for (int i = 0; i < 3 * RESIDUALS; ++i) record[i] = jp[i];
#pragma unroll
  for (int i = 0; i < RESIDUALS; ++i) record[3 * RESIDUALS + i] = r[i];
#pragma unroll
  for (int i = 0; i < RESIDUALS; ++i) {
#pragma unroll
    for (int k = 0; k < COLUMNS; ++k) record[JC + 8 * i + k] = jc[i * DOF + k];
#if !STEREO
    record[JC9 + i] = jc[i * DOF + 8];
#endif
  }
#pragma unroll
  for (int line = 0; line < JACOBIAN_STRIDE; line += 8) {
    transpose8(record + line);
#pragma unroll
    for (int lane = 0; lane < 8; ++lane) {
      vstore8(record[line + lane], 0, out + lane * JACOBIAN_STRIDE + line);
    }
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(jacobian_update)(
    __global const double* restrict cameras, __global const double* restrict state,
    __global const double* restrict point_scales, __global const int4* restrict chunks,
    __global const int* restrict slot_points, __global const double* restrict measured,
    __global const double* restrict weights, __global double* restrict jacobians,
    __global double* restrict partials, int slots, int chunk_count, int loss, double loss_scale) {
  const int chunk = (int)get_global_id(0);
  if (chunk >= chunk_count) return;
  const int4 at = chunks[chunk];
  __global const double* camera = cameras + (size_t)at.x * CAMERA_STRIDE;
  double8 U[DOF * (DOF + 1) / 2];
  double8 g[DOF];
#pragma unroll
  for (int i = 0; i < DOF * (DOF + 1) / 2; ++i) U[i] = (double8)(0);
#pragma unroll
  for (int i = 0; i < DOF; ++i) g[i] = (double8)(0);
  for (int slot = at.y; slot < at.y + at.z; slot += 8) {
    const int8 first = vload8(0, slot_points + slot) * 3;
    const double8 x[3] = {gather(state, first), gather(state, first + 1), gather(state, first + 2)};
    const double8 scale[3] = {gather(point_scales, first), gather(point_scales, first + 1),
                              gather(point_scales, first + 2)};
    double8 m[RESIDUALS];
#pragma unroll
    for (int i = 0; i < RESIDUALS; ++i)
      m[i] = vload8(0, measured + (size_t)i * (size_t)slots + slot);
    double8 r[RESIDUALS];
    double8 jc[RESIDUALS * DOF];
    double8 jp[RESIDUALS * 3];
    linearise(camera, x, scale, m, vload8(0, weights + slot), loss, loss_scale, r, jc, jp);
#pragma unroll
    for (int i = 0; i < RESIDUALS; ++i) {
      int entry = 0;
#pragma unroll
      for (int a = 0; a < DOF; ++a) {
#pragma unroll
        for (int b = a; b < DOF; ++b) {
          U[entry] = fma(jc[i * DOF + a], jc[i * DOF + b], U[entry]);
          ++entry;
        }
        g[a] = fma(jc[i * DOF + a], r[i], g[a]);
      }
    }
    store_records(r, jc, jp, jacobians + (size_t)slot * JACOBIAN_STRIDE);
  }
  __global double* out = partials + (size_t)chunk * PARTIAL;
  int entry = 0;
#pragma unroll
  for (int a = 0; a < DOF; ++a) {
#pragma unroll
    for (int b = a; b < DOF; ++b) {
      const double sum = sum8(U[entry++]);
      out[a * DOF + b] = sum;
      out[b * DOF + a] = sum;
    }
    out[BLOCK + a] = sum8(g[a]);
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(point_update)(
    __global const double* restrict jacobians, __global const int* restrict point_start,
    __global const int* restrict point_slots, __global const double* restrict point_scales,
    __global double* restrict blocks, __global double* restrict gradients, int points) {
  const int group = (int)get_global_id(0);
  const int end = min((group + 1) * GROUP_POINTS, points);
  double largest = 0;
  for (int point = group * GROUP_POINTS; point < end; ++point) {
    largest = fmax(largest,
                   point_block(jacobians, point_start, point_slots, point_scales, blocks, point));
  }
  gradients[group] = largest;
}
