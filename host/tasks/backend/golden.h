// Golden references of the bundle adjustment kernels: one observation, one point, one pair after
// the other, in the order of operations that all variants keep. T is double or float; floats add up
// in fixed point where many terms meet (kernels/backend/float1.clh).
#ifndef PARTITA_HOST_TASKS_BACKEND_GOLDEN_H
#define PARTITA_HOST_TASKS_BACKEND_GOLDEN_H

#include <span>

#include "host/tasks/backend/layout.h"

namespace partita::backend::golden {

/// What the kernels read; each of them some of it. Layouts: kernels/backend/layout.clh.
template <class T>
struct Inputs {
  bool stereo = false;
  int slots = 0, points = 0, loss = 0;
  T loss_scale = 1, inverse_radius = 0;
  std::span<const T> cameras, state, point_scales, measured, weights, steps;
  std::span<const int> chunks, slot_points, camera_chunks, pairs, entries;
  std::span<const int> point_start, point_slots, point_cameras;
  std::span<const T> jacobians, partials, blocks, factors, eliminated;
};

/// Weighted, robustified residuals and Jacobians of a slot seen by a camera (a record).
template <class T>
struct Linearised {
  T r[3], jc[27], jp[9];
};
template <class T>
Linearised<T> linearise(const Inputs<T>& in, std::span<const T> camera, int slot);

template <class T>
void jacobian_update(const Inputs<T>& in, std::span<T> jacobians, std::span<T> partials);
template <class T>
void point_update(const Inputs<T>& in, std::span<T> blocks, std::span<T> gradients);
template <class T>
void eliminate_points(const Inputs<T>& in, std::span<T> factors, std::span<T> eliminated);
template <class T>
void schur_complement(const Inputs<T>& in, std::span<T> blocks, std::span<T> camera_sums);
template <class T>
void back_substitute(const Inputs<T>& in, std::span<T> to, std::span<T> sums);
template <class T>
void cost(const Inputs<T>& in, std::span<T> costs);

}  // namespace partita::backend::golden

#endif  // PARTITA_HOST_TASKS_BACKEND_GOLDEN_H
