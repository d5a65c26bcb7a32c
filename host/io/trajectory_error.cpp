#include "host/io/trajectory_error.h"

#include <algorithm>
#include <cmath>

#include <Eigen/SVD>
#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::io {

namespace {

constexpr double kDegrees = 180.0 / 3.14159265358979323846;

/// Path length from the first frame to each.
std::vector<double> path_lengths(const Trajectory& poses) {
  std::vector<double> lengths(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    lengths[i] = lengths[i - 1] + (poses[i].translation() - poses[i - 1].translation()).norm();
  }
  return lengths;
}

double rotation_angle(const Eigen::Matrix3d& R) {
  return std::acos(std::clamp(0.5 * (R.trace() - 1), -1.0, 1.0));
}

std::optional<SegmentError> segment_error(const Trajectory& estimate, const Trajectory& truth,
                                          const std::vector<double>& lengths) {
  SegmentError sum;
  for (std::size_t first = 0; first < truth.size(); first += 10) {
    for (double length = 100; length <= 800; length += 100) {
      const auto found = std::upper_bound(lengths.begin() + static_cast<long>(first), lengths.end(),
                                          lengths[first] + length);
      if (found == lengths.end()) break;
      const auto last = static_cast<std::size_t>(found - lengths.begin());
      const Eigen::Isometry3d true_motion = truth[first].inverse() * truth[last];
      const Eigen::Isometry3d motion = estimate[first].inverse() * estimate[last];
      const Eigen::Isometry3d error = motion.inverse() * true_motion;
      sum.translation_percent += 100 * error.translation().norm() / length;
      sum.rotation_degrees_per_100m += 100 * kDegrees * rotation_angle(error.linear()) / length;
      ++sum.segments;
    }
  }
  if (sum.segments == 0) return std::nullopt;
  sum.translation_percent /= static_cast<double>(sum.segments);
  sum.rotation_degrees_per_100m /= static_cast<double>(sum.segments);
  return sum;
}

std::vector<Eigen::Vector3d> positions(const Trajectory& poses) {
  std::vector<Eigen::Vector3d> result;
  result.reserve(poses.size());
  for (const auto& pose : poses) result.emplace_back(pose.translation());
  return result;
}

}  // namespace

Eigen::Isometry3d align(const std::vector<Eigen::Vector3d>& from,
                        const std::vector<Eigen::Vector3d>& onto) {
  const double count = static_cast<double>(from.size());
  Eigen::Vector3d mean_from = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_onto = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    mean_from += from[i] / count;
    mean_onto += onto[i] / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    covariance += (onto[i] - mean_onto) * (from[i] - mean_from).transpose() / count;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d S = Eigen::Matrix3d::Identity();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) S(2, 2) = -1;
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = svd.matrixU() * S * svd.matrixV().transpose();
  result.translation() = mean_onto - result.linear() * mean_from;
  return result;
}

RelativeError relative_error(const Trajectory& estimate, const Trajectory& truth) {
  if (estimate.size() != truth.size() || truth.size() < 2) {
    throw Error(fmt::format("cannot compare trajectories: {} estimated poses, {} true ones",
                            estimate.size(), truth.size()));
  }
  double translation = 0, rotation = 0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Eigen::Isometry3d error = (estimate[i - 1].inverse() * estimate[i]).inverse() *
                                    (truth[i - 1].inverse() * truth[i]);
    translation += error.translation().squaredNorm();
    const double angle = Eigen::AngleAxisd(error.linear()).angle() * kDegrees;
    rotation += angle * angle;
  }
  const auto steps = static_cast<double>(truth.size() - 1);
  return {std::sqrt(translation / steps), std::sqrt(rotation / steps)};
}

TrajectoryError trajectory_error(const Trajectory& estimate, const Trajectory& truth) {
  if (estimate.size() != truth.size() || truth.empty()) {
    throw Error(fmt::format("cannot compare trajectories: {} estimated poses, {} true ones",
                            estimate.size(), truth.size()));
  }
  TrajectoryError result;
  const std::vector<double> lengths = path_lengths(truth);
  result.distance = lengths.back();
  const Eigen::Isometry3d true_motion = truth.front().inverse() * truth.back();
  const Eigen::Isometry3d motion = estimate.front().inverse() * estimate.back();
  result.end_error = (motion.translation() - true_motion.translation()).norm();
  if (result.distance > 0) result.end_error_percent = 100 * result.end_error / result.distance;

  const auto from = positions(estimate);
  const auto onto = positions(truth);
  const Eigen::Isometry3d T_true_estimate = align(from, onto);
  double squares = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    squares += (T_true_estimate * from[i] - onto[i]).squaredNorm();
  }
  result.ate_rmse = std::sqrt(squares / static_cast<double>(from.size()));
  result.segment = segment_error(estimate, truth, lengths);
  return result;
}

}  // namespace partita::io
