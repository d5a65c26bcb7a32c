// What is estimated at one moment: where the inertial unit is, how fast, and what its readings are
// off by.
#ifndef PARTITA_HOST_TASKS_FUSION_STATE_H
#define PARTITA_HOST_TASKS_FUSION_STATE_H

#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "host/tasks/fusion/so3.h"

namespace partita::fusion {

using Eigen::Matrix3d;
using Eigen::Vector3d;

inline constexpr int kStateSize = 15;
using StateVector = Eigen::Matrix<double, kStateSize, 1>;
using StateMatrix = Eigen::Matrix<double, kStateSize, kStateSize>;

/// Where each part begins in the vector of a state's changes.
enum Part : int { kRotation = 0, kPosition = 3, kVelocity = 6, kGyroBias = 9, kAccelBias = 12 };

struct Bias {
  Vector3d gyro = Vector3d::Zero();   ///< rad/s
  Vector3d accel = Vector3d::Zero();  ///< m/s^2
};

/// World axes: z up, against gravity; x east and y north once the world is the map's.
struct NavState {
  std::int64_t timestamp_ns = 0;
  Matrix3d R_world_imu = Matrix3d::Identity();
  Vector3d position = Vector3d::Zero();  ///< of the inertial unit, metres
  Vector3d velocity = Vector3d::Zero();  ///< in the world's axes, m/s
  Bias bias;

  /// The state changed by `d`: the rotation on its right (in the unit's axes), the rest added.
  NavState plus(const StateVector& d) const {
    NavState s = *this;
    s.R_world_imu = so3::normalised(R_world_imu * so3::exp(d.segment<3>(kRotation)));
    s.position += d.segment<3>(kPosition);
    s.velocity += d.segment<3>(kVelocity);
    s.bias.gyro += d.segment<3>(kGyroBias);
    s.bias.accel += d.segment<3>(kAccelBias);
    return s;
  }
  /// The change that leads from `other` to this state: other.plus(this->minus(other)) is this.
  StateVector minus(const NavState& other) const {
    StateVector d;
    d << so3::log(other.R_world_imu.transpose() * R_world_imu), position - other.position,
        velocity - other.velocity, bias.gyro - other.bias.gyro, bias.accel - other.bias.accel;
    return d;
  }
  Eigen::Isometry3d T_world_imu() const {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = R_world_imu;
    T.translation() = position;
    return T;
  }
};

/// Metres per second squared; the world's z axis points up.
inline constexpr double kGravity = 9.81;
inline Vector3d gravity() {
  return {0, 0, -kGravity};
}

inline double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<double>(to_ns - from_ns) * 1e-9;
}

}  // namespace partita::fusion

#endif  // PARTITA_HOST_TASKS_FUSION_STATE_H
