#include "host/tasks/backend/camera.h"

#include <cmath>

#include <Eigen/Geometry>

namespace partita::backend {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// sin(a)/a, (1 - cos(a))/a^2 and (1 - sin(a)/a)/a^2; their series where the quotients lose digits.
struct Coefficients {
  double a, b, c;
  explicit Coefficients(double square) {
    if (square < 1e-4) {
      a = 1 - square / 6 * (1 - square / 20 * (1 - square / 42));
      b = 0.5 * (1 - square / 12 * (1 - square / 30 * (1 - square / 56)));
      c = (1 - square / 20 * (1 - square / 42 * (1 - square / 72))) / 6;
    } else {
      const double angle = std::sqrt(square), half = std::sin(0.5 * angle);
      a = std::sin(angle) / angle;
      b = 2 * half * half / square;
      c = (1 - a) / square;
    }
  }
};

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& w) {
  const Coefficients k(w.squaredNorm());
  const Eigen::Matrix3d W = cross_matrix(w);
  return Eigen::Matrix3d::Identity() + k.a * W + k.b * W * W;
}

/// R(w + d) = exp(J d) R(w) to first order.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& w) {
  const Coefficients k(w.squaredNorm());
  const Eigen::Matrix3d W = cross_matrix(w);
  return Eigen::Matrix3d::Identity() + k.b * W + k.c * W * W;
}

}  // namespace

CameraRecord camera_record(const Problem& problem, const Camera& camera,
                           const std::array<double, 9>& scales) {
  CameraRecord record{};
  const Eigen::Vector3d w(camera[0], camera[1], camera[2]);
  const bool bal = problem.model == CameraModel::bal;
  const Eigen::Matrix3d R = rotation_of(w);
  const Eigen::Matrix3d J = bal ? left_jacobian(w) : Eigen::Matrix3d::Identity();
  for (int i = 0; i < 9; ++i) {
    record[static_cast<std::size_t>(i)] = R(i / 3, i % 3);
    record[static_cast<std::size_t>(kRotationAt + i)] =
        J(i / 3, i % 3) * scales[static_cast<std::size_t>(i % 3)];
  }
  for (std::size_t i = 0; i < 3; ++i) record[9 + i] = camera[3 + i];
  if (bal) {
    for (std::size_t i = 0; i < 3; ++i) record[12 + i] = camera[6 + i];
  } else {
    const StereoRig& rig = problem.rig;
    const std::array values{rig.fx, rig.fy, rig.cx, rig.cy, rig.baseline};
    for (std::size_t i = 0; i < values.size(); ++i) record[12 + i] = values[i];
  }
  for (std::size_t i = 0; i < 6; ++i) record[kScalesAt + i] = scales[3 + i];
  return record;
}

Camera moved(CameraModel model, const Camera& camera, const std::array<double, 9>& step) {
  Camera out = camera;
  const std::size_t first = model == CameraModel::bal ? 0 : 3;
  const std::size_t end = model == CameraModel::bal ? 9 : 6;
  for (std::size_t i = first; i < end; ++i) out[i] += step[i];
  if (model == CameraModel::bal) return out;
  const Eigen::Matrix3d R =
      rotation_of({step[0], step[1], step[2]}) * rotation_of({camera[0], camera[1], camera[2]});
  const Eigen::AngleAxisd turned(Eigen::Quaterniond(R).normalized());
  for (int i = 0; i < 3; ++i) {
    out[static_cast<std::size_t>(i)] = turned.angle() * turned.axis()[i];
  }
  return out;
}

}  // namespace partita::backend
