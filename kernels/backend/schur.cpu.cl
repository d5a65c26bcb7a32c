// SE, CPU: points are eliminated (a work-item per 64 points), then every pair of cameras gathers
// its block of the reduced system from the points that both see (a work-item per pair): no atomics,
// and sums in the order of the points. Vectors run over the camera's first eight columns.
#include "backend/double8.clh"
#include "backend/layout.clh"
#include "backend/point.clh"

inline __attribute__((always_inline)) void eliminate_slot(__global const double* record, Factor f,
                                                          __global double* out) {
  double8 z[3] = {(double8)(0), (double8)(0), (double8)(0)};
  double8 last = (double8)(0, 0, 0, f.y0, f.y1, f.y2, 0, 0);
#if !STEREO
  double z9[3] = {0, 0, 0};
#endif
#pragma unroll
  for (int i = 0; i < RESIDUALS; ++i) {
    double A[3];
    eliminate_row(f, record + 3 * i, A);
    const double8 row = vload8(0, record + JC + 8 * i);
#pragma unroll
    for (int k = 0; k < 3; ++k) {
      z[k] = fma(row, (double8)(A[k]), z[k]);
#if !STEREO
      z9[k] = fma(record[JC9 + i], A[k], z9[k]);
#endif
    }
  }
#if !STEREO
  last.s012 = (double3)(z9[0], z9[1], z9[2]);
#endif
#pragma unroll
  for (int k = 0; k < 3; ++k) vstore8(z[k], (size_t)k, out);
  vstore8(last, 3, out);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(eliminate_points)(
    __global const double* restrict jacobians, __global const int* restrict point_start,
    __global const int* restrict point_slots, __global const double* restrict blocks,
    __global double* restrict factors, __global double* restrict eliminated, int points,
    double inverse_radius) {
  const int group = (int)get_global_id(0);
  const int end = min((group + 1) * GROUP_POINTS, points);
  for (int point = group * GROUP_POINTS; point < end; ++point) {
    const Factor f = factorise_point(blocks + (size_t)point * 9, inverse_radius);
    store_factor(f, factors + (size_t)point * 9);
    for (int i = point_start[point]; i < point_start[point + 1]; ++i) {
      const size_t slot = (size_t)point_slots[i];
      eliminate_slot(jacobians + slot * JACOBIAN_STRIDE, f, eliminated + slot * ELIMINATED_STRIDE);
    }
  }
}

// A block of S: rows of eight columns, then its ninth column and the corner; a right-hand side.
typedef struct {
  double8 row[DOF];
  double8 column;
  double corner;
  double rhs[DOF];
} Sums;

// The sums over the chunks of a camera: U into S and its diagonal, g into the right-hand side.
inline __attribute__((always_inline)) void begin_diagonal(__global const double* partials,
                                                          int first, int end, Sums* S,
                                                          __global double* out) {
  double diagonal[DOF];
#pragma unroll
  for (int r = 0; r < DOF; ++r) diagonal[r] = 0;
  for (int chunk = first; chunk < end; ++chunk) {
    __global const double* U = partials + (size_t)chunk * PARTIAL;
#pragma unroll
    for (int r = 0; r < DOF; ++r) {
#if STEREO
      S->row[r] += (double8)(vload4(0, U + r * DOF), vload2(0, U + r * DOF + 4), 0, 0);
#else
      S->row[r] += vload8(0, U + r * DOF);
#endif
      diagonal[r] += U[r * DOF + r];
      S->rhs[r] -= U[BLOCK + r];
    }
#if !STEREO
    S->column += vload8(0, U + 8 * DOF);  // U is symmetric
    S->corner += U[8 * DOF + 8];
#endif
  }
#pragma unroll
  for (int r = 0; r < DOF; ++r) {
    out[DOF + r] = -S->rhs[r];
    out[2 * DOF + r] = diagonal[r];
  }
}

// S -= Zi Zj'
inline __attribute__((always_inline)) void subtract_product(__global const double* zi,
                                                            __global const double* zj, Sums* S) {
#pragma unroll
  for (int k = 0; k < 3; ++k) {
    const double8 row = vload8((size_t)k, zj);
#pragma unroll
    for (int r = 0; r < COLUMNS; ++r) S->row[r] = fma((double8)(-zi[8 * k + r]), row, S->row[r]);
#if !STEREO
    const double i9 = -zi[24 + k];
    const double j9 = zj[24 + k];
    S->row[8] = fma((double8)(i9), row, S->row[8]);
    S->column = fma(-vload8((size_t)k, zi), (double8)(j9), S->column);
    S->corner = fma(i9, j9, S->corner);
#endif
  }
}

inline __attribute__((always_inline)) void add_to_rhs(__global const double* z, Sums* S) {
#pragma unroll
  for (int k = 0; k < 3; ++k) {
#pragma unroll
    for (int r = 0; r < COLUMNS; ++r) S->rhs[r] = fma(z[8 * k + r], z[27 + k], S->rhs[r]);
#if !STEREO
    S->rhs[8] = fma(z[24 + k], z[27 + k], S->rhs[8]);
#endif
  }
}

inline __attribute__((always_inline)) void store_block(const Sums* S, __global double* out) {
#if !STEREO
  double last[8];
  vstore8(S->column, 0, last);
#endif
#pragma unroll
  for (int r = 0; r < DOF; ++r) {
    double row[8];
    vstore8(S->row[r], 0, row);
#pragma unroll
    for (int c = 0; c < COLUMNS; ++c) out[r * DOF + c] = row[c];
#if !STEREO
    out[r * DOF + 8] = r < 8 ? last[r] : S->corner;
#endif
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void MODEL(schur_complement)(
    __global const double* restrict eliminated, __global const double* restrict partials,
    __global const int4* restrict pairs, __global const int2* restrict entries,
    __global const int* restrict camera_chunks, __global double* restrict blocks,
    __global double* restrict camera_sums, int pair_count) {
  const int pair = (int)get_global_id(0);
  if (pair >= pair_count) return;
  const int4 at = pairs[pair];  // first entry, its end, camera, other camera
  Sums S;
  S.column = (double8)(0);
  S.corner = 0;
#pragma unroll
  for (int r = 0; r < DOF; ++r) {
    S.row[r] = (double8)(0);
    S.rhs[r] = 0;
  }
  const bool diagonal = at.z == at.w;
  __global double* sums = camera_sums + (size_t)at.z * (3 * DOF);
  if (diagonal) {
    begin_diagonal(partials, camera_chunks[at.z], camera_chunks[at.z + 1], &S, sums);
  }
  for (int entry = at.x; entry < at.y; ++entry) {
    const int2 slots = entries[entry];
    __global const double* zi = eliminated + (size_t)slots.x * ELIMINATED_STRIDE;
    subtract_product(zi, eliminated + (size_t)slots.y * ELIMINATED_STRIDE, &S);
    if (diagonal && slots.x == slots.y) add_to_rhs(zi, &S);
  }
  store_block(&S, blocks + (size_t)pair * BLOCK);
  if (diagonal) {
#pragma unroll
    for (int r = 0; r < DOF; ++r) sums[r] = S.rhs[r];
  }
}
