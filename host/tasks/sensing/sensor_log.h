// Everything that a drive's instruments recorded apart from pictures, on one clock.
#ifndef PARTITA_HOST_TASKS_SENSING_SENSOR_LOG_H
#define PARTITA_HOST_TASKS_SENSING_SENSOR_LOG_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/tasks/sensing/frame.h"

namespace partita::sensing {

/// White noise and random walk of an inertial unit, as densities (per square root of a second).
/// The defaults are those of a cheap unit on a running car, vibration included.
struct ImuNoise {
  double gyro_density = 2e-3;   ///< rad/s/sqrt(Hz)
  double accel_density = 5e-2;  ///< m/s^2/sqrt(Hz)
  double gyro_walk = 2e-5;      ///< rad/s^2/sqrt(Hz)
  double accel_walk = 1e-3;     ///< m/s^3/sqrt(Hz)
  double gyro_bias = 0.005;     ///< standard deviation of the unknown bias at the start, rad/s
  double accel_bias = 0.3;      ///< the same, m/s^2
};

/// A true pose at its time: T_world_imu.
struct TimedPose {
  std::int64_t timestamp_ns = 0;
  Pose T_world_imu = Pose::Identity();
  std::optional<Eigen::Vector3d> velocity;  ///< in the world's axes, where the truth has it
  std::optional<Eigen::Vector3d> gyro_bias;
  std::optional<Eigen::Vector3d> accel_bias;
};

struct SensorLog {
  std::vector<ImuSample> imu;  ///< in the unit's own axes, strictly increasing times
  std::vector<GpsFix> gps;     ///< strictly increasing times
  ImuNoise noise;
  Pose T_imu_cam = Pose::Identity();  ///< the left, rectified camera in the unit's axes
  /// Set for a vehicle on wheels: x forward, y left, z up in the unit's axes.
  std::optional<Eigen::Matrix3d> R_imu_vehicle;
  std::vector<TimedPose> truth;  ///< empty: unknown
  std::vector<std::string> notices;
};

/// Camera axes (x right, y down, z forward) of a car whose camera looks ahead.
inline Eigen::Matrix3d vehicle_in_camera_axes() {
  Eigen::Matrix3d R;
  R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return R;
}

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_SENSOR_LOG_H
