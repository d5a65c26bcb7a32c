// The camera's motion from matches, on the host: three-point hypotheses (RANSAC with a seed of its
// own), then least squares over the inliers with a robust loss (Ceres, one thread). The same
// matches give the same motion.
#ifndef PARTITA_HOST_TASKS_FRONTEND_MOTION_H
#define PARTITA_HOST_TASKS_FRONTEND_MOTION_H

#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/tasks/frontend/frontend.h"

namespace partita::frontend {

/// A landmark that the reference frame measured by stereo, seen again in the current one.
struct Observation {
  Eigen::Vector3d point;  ///< reference camera's axes, metres
  Eigen::Vector2d pixel;  ///< in the current left image
};

struct MotionEstimate {
  Pose T_current_reference = Pose::Identity();
  std::vector<bool> inliers;  ///< one per observation
  int inlier_count = 0;
  int hypotheses = 0;  ///< evaluated
  int iterations = 0;  ///< of the least squares
};

/// `predicted` is the first hypothesis and the start of the others. With fewer than three
/// observations the prediction is returned, without inliers.
MotionEstimate estimate_motion(std::span<const Observation> observations,
                               const StereoCalibration& calibration, const Pose& predicted,
                               const FrontendParameters& parameters);

/// Reprojection error in pixels; infinite for a point behind the camera.
double reprojection_error(const Observation& observation, const StereoCalibration& calibration,
                          const Pose& T_current_reference);

/// The motion that, done `times` times over, makes up `motion` (times > 0), or the motion done
/// `times` times: angle and translation are scaled, which is exact for motion along one axis and
/// close for a car's.
Pose scaled_motion(const Pose& motion, double times);

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_MOTION_H
