// The street's course, the vehicle's motion along it, and what its inertial unit and GPS receiver
// read. World axes: x to the right, y down, z along the street; the ground is y = 0.
#ifndef PARTITA_HOST_TASKS_SENSING_SCENARIO_MOTION_H
#define PARTITA_HOST_TASKS_SENSING_SCENARIO_MOTION_H

#include <cstdint>

#include "host/tasks/sensing/frame.h"
#include "host/tasks/sensing/scenario_math.h"

namespace partita::sensing::scenario {

/// The street's centre line x = c(z): two superposed waves whose phases the seed draws. It is
/// analytic, so that the vehicle's rates and accelerations are exact derivatives of its poses.
class Street {
 public:
  explicit Street(std::uint64_t seed);
  double centre(double z) const;
  double slope(double z) const;      ///< dc/dz
  double curvature(double z) const;  ///< d2c/dz2

 private:
  double phase_[2];
};

struct MotionState {
  Vec3 position;  ///< of the left camera
  Rotation R_world_cam;
  Vec3 angular_velocity;  ///< in the camera's axes, rad/s
  Vec3 specific_force;    ///< in the camera's axes, m/s^2
};

/// A car in the right lane, 5.6 m/s along z, that heads where it goes, and bounces, pitches and
/// rolls a little on its springs.
class Motion {
 public:
  explicit Motion(std::uint64_t seed) : seed_(seed), street_(seed) {}

  MotionState state(double seconds) const;
  const Street& street() const { return street_; }

  /// Reading number k of the inertial unit (200 Hz) and of the receiver (5 Hz), noise included: a
  /// constant bias drawn from the seed, and white noise. Positions are metres east (x), north (z)
  /// and up (-y) of the camera's first position.
  ImuSample imu(std::int64_t k) const;
  GpsFix gps(std::int64_t k) const;

  static constexpr std::int64_t kImuPeriodNs = 5'000'000;
  static constexpr std::int64_t kGpsPeriodNs = 200'000'000;
  static constexpr double kSpeed = 5.6;  ///< m/s along z
  static constexpr double kLane = 1.7;   ///< metres right of the centre line
  static constexpr double kCameraHeight = 1.65;

 private:
  std::uint64_t seed_;
  Street street_;
};

/// T_world_cam of a state, seen from another: the first camera's axes are the world of a
/// trajectory.
Pose relative_pose(const MotionState& world, const MotionState& camera);

}  // namespace partita::sensing::scenario

#endif  // PARTITA_HOST_TASKS_SENSING_SCENARIO_MOTION_H
