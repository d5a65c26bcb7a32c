// What the device needs to know of a camera, and how a camera takes a step.
#ifndef PARTITA_HOST_TASKS_BACKEND_CAMERA_H
#define PARTITA_HOST_TASKS_BACKEND_CAMERA_H

#include <array>

#include "host/tasks/backend/layout.h"
#include "host/tasks/backend/problem.h"

namespace partita::backend {

using CameraRecord = std::array<double, kCameraStride>;

/// kernels/backend/layout.clh: `camera`. `scales`: of the columns; 0 for what stays fixed.
CameraRecord camera_record(const Problem& problem, const Camera& camera,
                           const std::array<double, 9>& scales);

/// The camera after an unscaled step. bal: added. stereo: the rotation's step multiplies from the
/// left, exp(step) R, which has no singularity at half a turn.
Camera moved(CameraModel model, const Camera& camera, const std::array<double, 9>& step);

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_CAMERA_H
