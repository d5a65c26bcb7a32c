// JU, GPU: a work-group per chunk, a work-item per slot; then a work-item per entry of U and g,
// which adds eight lanes and their sum in the CPU variant's order. Assumptions as there.
#include "backend/double1.clh"
#include "backend/lanes.clh"
#include "backend/layout.clh"
#include "backend/point.clh"
#include "backend/projection.clh"

// Of a slot in local memory: the rows of Jc, then r.
#define ROWS (RESIDUALS * DOF + RESIDUALS)

__kernel __attribute__((reqd_work_group_size(CHUNK, 1, 1))) void MODEL(jacobian_update)(
    __global const double* restrict cameras, __global const double* restrict state,
    __global const double* restrict point_scales, __global const int4* restrict chunks,
    __global const int* restrict slot_points, __global const double* restrict measured,
    __global const double* restrict weights, __global double* restrict jacobians,
    __global double* restrict partials, int slots, int chunk_count, int loss, double loss_scale) {
  __local double rows[ROWS * CHUNK];
  const int chunk = (int)get_group_id(0);
  const int item = (int)get_local_id(0);
  const int4 at = chunk < chunk_count ? chunks[chunk] : (int4)(0);
  if (item < at.z) {
    const size_t slot = (size_t)(at.y + item);
    const size_t first = (size_t)slot_points[slot] * 3;
    const double x[3] = {state[first], state[first + 1], state[first + 2]};
    const double scale[3] = {point_scales[first], point_scales[first + 1], point_scales[first + 2]};
    double m[RESIDUALS];
    for (int i = 0; i < RESIDUALS; ++i) m[i] = measured[(size_t)i * (size_t)slots + slot];
    double r[RESIDUALS];
    double jc[RESIDUALS * DOF];
    double jp[RESIDUALS * 3];
    linearise(cameras + (size_t)at.x * CAMERA_STRIDE, x, scale, m, weights[slot], loss, loss_scale,
              r, jc, jp);
    store_record(r, jc, jp, jacobians + slot * JACOBIAN_STRIDE);
    for (int i = 0; i < RESIDUALS * DOF; ++i) rows[i * CHUNK + item] = jc[i];
    for (int i = 0; i < RESIDUALS; ++i) rows[(RESIDUALS * DOF + i) * CHUNK + item] = r[i];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item < PARTIAL && chunk < chunk_count) {
    const int a = item < BLOCK ? item / DOF : item - BLOCK;
    const int b = item % DOF;
    // The entries below the diagonal are those above it.
    __local const double* left = rows + min(a, item < BLOCK ? b : a) * CHUNK;
    __local const double* right =
        item < BLOCK ? rows + max(a, b) * CHUNK : rows + RESIDUALS * DOF * CHUNK;
    const int right_step = item < BLOCK ? DOF * CHUNK : CHUNK;
    double lanes[8] = {0, 0, 0, 0, 0, 0, 0, 0};
    for (int base = 0; base < at.z; base += 8) {
      for (int i = 0; i < RESIDUALS; ++i) {
        for (int lane = 0; lane < 8; ++lane) {
          lanes[lane] = fma(left[i * DOF * CHUNK + base + lane],
                            right[i * right_step + base + lane], lanes[lane]);
        }
      }
    }
    partials[(size_t)chunk * PARTIAL + (size_t)item] = sum_lanes(lanes);
  }
}

__kernel __attribute__((reqd_work_group_size(GROUP_POINTS, 1, 1))) void MODEL(point_update)(
    __global const double* restrict jacobians, __global const int* restrict point_start,
    __global const int* restrict point_slots, __global const double* restrict point_scales,
    __global double* restrict blocks, __global double* restrict gradients, int points) {
  __local double largest[GROUP_POINTS];
  const int point = (int)get_global_id(0);
  const int item = (int)get_local_id(0);
  largest[item] = 0;
  if (point < points) {
    largest[item] =
        fmax(0.0, point_block(jacobians, point_start, point_slots, point_scales, blocks, point));
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0) {
    double most = 0;
    for (int i = 0; i < GROUP_POINTS; ++i) most = fmax(most, largest[i]);
    gradients[get_group_id(0)] = most;
  }
}
