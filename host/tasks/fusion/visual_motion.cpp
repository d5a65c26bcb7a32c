#include "host/tasks/fusion/visual_motion.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace partita::fusion {
namespace {

constexpr double kPixelSigma = 0.4;
constexpr double kDisparitySigma = 0.3;
constexpr double kLeastDisparity = 1.5;
constexpr double kIndependent = 0.25;  ///< share of the information that counts
/// Vision is never better than this between two frames: exposure, rolling, time stamps.
constexpr double kLeastTurnSigma = 5e-5;   ///< rad
constexpr double kLeastShiftSigma = 5e-4;  ///< metres
constexpr double kGuessTurnSigma = 0.05;
constexpr double kGuessShiftSigma = 0.5;

Matrix6d information_of(double turn_sigma, double shift_sigma) {
  Matrix6d information = Matrix6d::Zero();
  information.diagonal().head<3>().setConstant(1 / (turn_sigma * turn_sigma));
  information.diagonal().tail<3>().setConstant(1 / (shift_sigma * shift_sigma));
  return information;
}

}  // namespace

Matrix6d motion_information(const std::vector<frontend::Feature>& features,
                            const sensing::StereoCalibration& c) {
  Matrix6d information = Matrix6d::Zero();
  for (const frontend::Feature& feature : features) {
    if (!feature.inlier || feature.disparity < kLeastDisparity) continue;
    const double z = c.fx * c.baseline / feature.disparity;
    const Vector3d P((feature.x - c.cx) * z / c.fx, (feature.y - c.cy) * z / c.fy, z);
    Eigen::Matrix<double, 2, 3> to_pixel;
    to_pixel << c.fx / z, 0, -c.fx * P.x() / (z * z), 0, c.fy / z, -c.fy * P.y() / (z * z);
    // The landmark was measured in the earlier camera, about one step of motion along z from here:
    // its depth's error shows in the pixel as far as the step makes it.
    const double step = 1.0;
    const Eigen::Vector2d by_disparity =
        to_pixel * P * (-1.0 / feature.disparity) +
        to_pixel * Vector3d(0, 0, step) * (1.0 / feature.disparity);
    const Eigen::Matrix2d covariance =
        kPixelSigma * kPixelSigma * Eigen::Matrix2d::Identity() +
        kDisparitySigma * kDisparitySigma * by_disparity * by_disparity.transpose();
    Eigen::Matrix<double, 2, 6> J;
    J.leftCols<3>() = to_pixel * so3::hat(P);
    J.rightCols<3>() = -to_pixel;
    information += J.transpose() * covariance.inverse() * J;
  }
  // Add the floor as a covariance, so that it bounds the best directions only.
  const Matrix6d weak = information * kIndependent + information_of(1.0, 10.0);
  const Matrix6d floor = information_of(kLeastTurnSigma, kLeastShiftSigma).inverse();
  return (weak.inverse() + floor).inverse();
}

void VisualTrack::add(const frontend::FrontendResult& result, std::int64_t timestamp_ns) {
  VisualFrame frame;
  frame.timestamp_ns = timestamp_ns;
  frame.T_world_cam = result.T_world_cam;
  if (!result.first && !result.tracked) ++lost_;
  if (!result.first && (result.tracked || guess_) && !frames_.empty()) {
    const std::int64_t wanted = result.tracked ? result.reference : numbers_.back();
    const auto reference = std::find(numbers_.rbegin(), numbers_.rend(), wanted);
    if (reference != numbers_.rend()) {
      const VisualFrame& from = frames_[static_cast<std::size_t>(numbers_.rend() - reference) - 1];
      VisualMotion motion;
      motion.T_from_to = from.T_world_cam.inverse() * result.T_world_cam;
      motion.information = result.tracked ? motion_information(result.features, calibration_)
                                          : information_of(kGuessTurnSigma, kGuessShiftSigma);
      frame.motion = motion;
      frame.reference_ns = from.timestamp_ns;
    }
  }
  frames_.push_back(frame);
  numbers_.push_back(result.frame);
}

}  // namespace partita::fusion
