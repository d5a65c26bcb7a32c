#include "host/io/trajectory.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "host/io/file.h"
#include "host/io/text.h"
#include "host/runtime/error.h"

namespace partita::io {

namespace {

constexpr double kRotationTolerance = 1e-3;

/// Minus zero prints a sign that equal results need not share; adding zero takes it away.
double unsigned_zero(double value) {
  return value + 0.0;
}

bool is_rotation(const Eigen::Matrix3d& R) {
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  return off <= kRotationTolerance && R.determinant() > 0;
}

}  // namespace

void write_kitti_trajectory(const std::string& path, const Trajectory& poses) {
  std::string text;
  for (const Eigen::Isometry3d& pose : poses) {
    for (int i = 0; i < 12; ++i) {
      fmt::format_to(std::back_inserter(text), "{:.12e}{}",
                     unsigned_zero(pose.matrix()(i / 4, i % 4)), i == 11 ? '\n' : ' ');
    }
  }
  write_file(path, text);
}

Trajectory read_kitti_trajectory(const std::string& path) {
  const TextFile file(path);
  Trajectory poses;
  poses.reserve(file.rows().size());
  for (const TextRow& row : file.rows()) {
    const auto values = file.numbers(row, 0, 12, "the 12 of a 3x4 pose");
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int i = 0; i < 12; ++i) pose.matrix()(i / 4, i % 4) = values[static_cast<std::size_t>(i)];
    if (!is_rotation(pose.linear())) {
      file.fail(row, "the 3x3 part is not a rotation, expected a 3x4 pose row by row");
    }
    poses.push_back(pose);
  }
  return poses;
}

void write_tum_trajectory(const std::string& path, const std::vector<std::int64_t>& timestamps_ns,
                          const Trajectory& poses) {
  if (timestamps_ns.size() != poses.size()) {
    throw Error(fmt::format("cannot write '{}': {} timestamps for {} poses", path,
                            timestamps_ns.size(), poses.size()));
  }
  std::string text;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Eigen::Quaterniond q(poses[i].linear());
    q.normalize();
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    const Eigen::Vector3d t = poses[i].translation();
    const std::int64_t ns = timestamps_ns[i];
    fmt::format_to(std::back_inserter(text), "{}{}.{:09}", ns < 0 ? "-" : "",
                   std::abs(ns / 1'000'000'000), std::abs(ns % 1'000'000'000));
    for (const double v : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
      fmt::format_to(std::back_inserter(text), " {:.12e}", unsigned_zero(v));
    }
    text += '\n';
  }
  write_file(path, text);
}

TimedTrajectory read_tum_trajectory(const std::string& path) {
  const TextFile file(path);
  TimedTrajectory result;
  for (const TextRow& row : file.rows()) {
    const auto v = file.numbers(row, 0, 8, "the 8 of 't tx ty tz qx qy qz qw'");
    if (std::abs(v[0]) > 9e9) file.fail(row, "the time is out of range, expected seconds");
    Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
    if (!(std::abs(q.norm() - 1) <= kRotationTolerance)) {
      file.fail(row, "the quaternion is not of length 1");
    }
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = q.normalized().toRotationMatrix();
    pose.translation() = Eigen::Vector3d(v[1], v[2], v[3]);
    result.timestamps_ns.push_back(std::llround(v[0] * 1e9));
    result.poses.push_back(pose);
  }
  return result;
}

}  // namespace partita::io
