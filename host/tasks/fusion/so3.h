// Rotations and their small changes, as Forster et al. write them ("On-Manifold Preintegration for
// Real-Time Visual-Inertial Odometry", IEEE T-RO 2017, section III).
#ifndef PARTITA_HOST_TASKS_FUSION_SO3_H
#define PARTITA_HOST_TASKS_FUSION_SO3_H

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace partita::fusion::so3 {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// hat(a) * b = a x b.
inline Matrix3d hat(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Below this angle (rad) the series' first terms are exact to double precision.
inline constexpr double kSmallAngle = 1e-5;

/// Rodrigues' formula (their equation 3).
inline Matrix3d exp(const Vector3d& phi) {
  const double angle = phi.norm();
  const Matrix3d K = hat(phi);
  if (angle < kSmallAngle) return Matrix3d::Identity() + K + 0.5 * K * K;
  return Matrix3d::Identity() + std::sin(angle) / angle * K +
         (1 - std::cos(angle)) / (angle * angle) * K * K;
}

/// The rotation vector of R, of length 0..pi. By quaternion, which is exact near pi, too.
inline Vector3d log(const Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < kSmallAngle) return 2 / q.w() * q.vec();
  return 2 * std::atan2(sine, q.w()) / sine * q.vec();
}

/// Right Jacobian: exp(phi + d) = exp(phi) exp(J d) to first order in d (their equations 7, 8).
inline Matrix3d right_jacobian(const Vector3d& phi) {
  const double angle = phi.norm();
  const Matrix3d K = hat(phi);
  if (angle < kSmallAngle) return Matrix3d::Identity() - 0.5 * K + K * K / 6;
  const double squared = angle * angle;
  return Matrix3d::Identity() - (1 - std::cos(angle)) / squared * K +
         (angle - std::sin(angle)) / (squared * angle) * K * K;
}

/// Its inverse: log(exp(phi) exp(d)) = phi + J^-1 d to first order (their equation 9). |phi| < pi.
inline Matrix3d inverse_right_jacobian(const Vector3d& phi) {
  const double angle = phi.norm();
  const Matrix3d K = hat(phi);
  if (angle < kSmallAngle) return Matrix3d::Identity() + 0.5 * K + K * K / 12;
  const double squared = angle * angle;
  return Matrix3d::Identity() + 0.5 * K +
         (1 / squared - (1 + std::cos(angle)) / (2 * angle * std::sin(angle))) * K * K;
}

/// The nearest rotation: takes away what rounding adds over many products.
inline Matrix3d normalised(const Matrix3d& R) {
  return Eigen::Quaterniond(R).normalized().toRotationMatrix();
}

/// Rotation about the vertical (z) axis that comes closest to R: its yaw.
inline double yaw(const Matrix3d& R) {
  return std::atan2(R(1, 0), R(0, 0));
}

}  // namespace partita::fusion::so3

#endif  // PARTITA_HOST_TASKS_FUSION_SO3_H
