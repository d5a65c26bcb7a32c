// SE, GPU: a work-item per point; then a work-group per pair of cameras, a work-item per entry of
// its block (and, for a camera with itself, of its right-hand side).
#include "backend/double1.clh"
#include "backend/lanes.clh"
#include "backend/layout.clh"
#include "backend/point.clh"

#define GROUP_PAIR ((PARTIAL + 31) / 32 * 32)

__kernel __attribute__((reqd_work_group_size(GROUP_POINTS, 1, 1))) void MODEL(eliminate_points)(
    __global const double* restrict jacobians, __global const int* restrict point_start,
    __global const int* restrict point_slots, __global const double* restrict blocks,
    __global double* restrict factors, __global double* restrict eliminated, int points,
    double inverse_radius) {
  const int point = (int)get_global_id(0);
  if (point >= points) return;
  const Factor f = factorise_point(blocks + (size_t)point * 9, inverse_radius);
  store_factor(f, factors + (size_t)point * 9);
  for (int i = point_start[point]; i < point_start[point + 1]; ++i) {
    const size_t slot = (size_t)point_slots[i];
    eliminate_slot(jacobians + slot * JACOBIAN_STRIDE, f, eliminated + slot * ELIMINATED_STRIDE);
  }
}

// Where column c of row k of Z' is.
inline __attribute__((always_inline)) int column_at(int k, int c) {
  return c < 8 ? 8 * k + c : 24 + k;
}

__kernel __attribute__((reqd_work_group_size(GROUP_PAIR, 1, 1))) void MODEL(schur_complement)(
    __global const double* restrict eliminated, __global const double* restrict partials,
    __global const int4* restrict pairs, __global const int2* restrict entries,
    __global const int* restrict camera_chunks, __global double* restrict blocks,
    __global double* restrict camera_sums, int pair_count) {
  const int pair = (int)get_group_id(0);
  const int item = (int)get_local_id(0);
  if (pair >= pair_count) return;
  const int4 at = pairs[pair];
  const bool diagonal = at.z == at.w;
  if (item >= (diagonal ? PARTIAL : BLOCK)) return;
  const bool rhs = item >= BLOCK;
  const int r = rhs ? item - BLOCK : item / DOF;
  const int c = item % DOF;
  double sum =
      0;  // of S, what is subtracted from it; so that one loop serves S and right-hand side
  if (diagonal) {
    for (int chunk = camera_chunks[at.z]; chunk < camera_chunks[at.z + 1]; ++chunk) {
      const double part = partials[(size_t)chunk * PARTIAL + (size_t)item];
      sum -= part;
    }
    __global double* sums = camera_sums + (size_t)at.z * (3 * DOF);
    if (rhs) sums[DOF + r] = -sum;
    if (!rhs && r == c) sums[2 * DOF + r] = -sum;
  }
  for (int entry = at.x; entry < at.y; ++entry) {
    const int2 slots = entries[entry];
    if (rhs && slots.x != slots.y) continue;
    __global const double* zi = eliminated + (size_t)slots.x * ELIMINATED_STRIDE;
    __global const double* zj = eliminated + (size_t)slots.y * ELIMINATED_STRIDE;
    for (int k = 0; k < 3; ++k) {
      sum = fma(zi[column_at(k, r)], zj[rhs ? 27 + k : column_at(k, c)], sum);
    }
  }
  if (rhs) {
    camera_sums[(size_t)at.z * (3 * DOF) + (size_t)r] = sum;
  } else {
    blocks[(size_t)pair * BLOCK + (size_t)item] = -sum;
  }
}
