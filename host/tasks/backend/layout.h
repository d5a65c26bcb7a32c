// Sizes of the records that host and device share; kernels/backend/layout.clh says what is in them.
#ifndef PARTITA_HOST_TASKS_BACKEND_LAYOUT_H
#define PARTITA_HOST_TASKS_BACKEND_LAYOUT_H

#include "host/tasks/backend/problem.h"

namespace partita::backend {

inline constexpr int kCameraStride = 32;
inline constexpr int kRotationAt = 17;  ///< the rotation's left Jacobian times its columns' scales
inline constexpr int kScalesAt = 26;    ///< scales of the other columns
inline constexpr int kEliminatedStride = 32;
inline constexpr int kChunk = 128;       ///< slots of a chunk, at most
inline constexpr int kGroupPoints = 64;  ///< points of a work-item (cpu) or work-group (gpu)
inline constexpr int kLanes = 8;
inline constexpr int kPointBlock = 9;
inline constexpr int kStepStride = 9;

/// What differs between the camera models.
struct Layout {
  int dof = 9;        ///< columns of a camera
  int residuals = 2;  ///< of an observation
  int jacobian_stride = 32;
  int jc_at = 8;    ///< where the rows of Jc begin
  int jc9_at = 24;  ///< its ninth column, where there is one

  int block() const { return dof * dof; }
  int partial() const { return dof * dof + dof; }
  int columns() const { return dof < 8 ? dof : 8; }
};

inline constexpr Layout layout_of(CameraModel model) {
  return model == CameraModel::bal
             ? Layout{.dof = 9, .residuals = 2, .jacobian_stride = 32, .jc_at = 8, .jc9_at = 24}
             : Layout{.dof = 6, .residuals = 3, .jacobian_stride = 40, .jc_at = 16, .jc9_at = -1};
}

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_LAYOUT_H
