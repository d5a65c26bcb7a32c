// Where an estimate begins: which way is down, how fast the vehicle is, what the gyro reads at
// rest.
#ifndef PARTITA_HOST_TASKS_FUSION_INITIALISE_H
#define PARTITA_HOST_TASKS_FUSION_INITIALISE_H

#include <optional>
#include <span>
#include <vector>

#include "host/tasks/fusion/preintegration.h"
#include "host/tasks/sensing/frame.h"

namespace partita::fusion {

using sensing::GpsFix;
using sensing::Pose;

/// A state to begin with, and how uncertain each part of it is (standard deviations). Its yaw is 0
/// and its position the origin where nothing says more.
struct Initial {
  NavState state;
  StateVector sigma = StateVector::Zero();
  bool in_map = false;  ///< position and yaw are the map's
};

/// The attitude of yaw 0 in which `up` (in the unit's axes) points up.
Matrix3d level(const Vector3d& up);

/// What a stretch of readings says about whether the unit stands still.
struct Rest {
  bool still = false;   ///< scatters as little as a unit's own noise and an idling engine make it
  bool steady = false;  ///< no more than running rotors or a road: another sensor has to confirm it
  double seconds = 0;
  Vector3d mean_gyro = Vector3d::Zero();
  Vector3d mean_accel = Vector3d::Zero();
  double gyro_deviation = 0;   ///< root mean square about the mean, all axes, rad/s
  double accel_deviation = 0;  ///< m/s^2
};
/// Still: the readings scatter about their mean as little as a unit's own noise and a running
/// engine make them. Even driving on a smooth road can look so: let another sensor confirm it where
/// there is one. Needs kRestSeconds of readings.
Rest observe_rest(std::span<const ImuSample> samples);
inline constexpr double kRestSeconds = 0.5;

/// At rest: gravity gives roll and pitch, the gyro's mean is its bias, the velocity is zero. The
/// accelerometer's bias cannot be told from a tilt; along gravity it can.
Initial initialise_at_rest(const Rest& rest, std::int64_t time_ns, const ImuNoise& noise);

/// On the move, by GPS: velocity and yaw from speed and course, or from a line through the fixes;
/// gravity from the mean specific force less the acceleration that turning makes. The course is
/// turned on by what the gyro shows over the receiver's lag. Nothing where the
/// fixes do not say where the vehicle heads. `R_imu_vehicle`: see WheelConstraint.
std::optional<Initial> initialise_by_gps(std::span<const ImuSample> samples,
                                         std::span<const GpsFix> fixes,
                                         const Matrix3d& R_imu_vehicle, const ImuNoise& noise,
                                         double velocity_lag_seconds);

/// The camera's motion between two times.
struct TimedMotion {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  Pose T_from_to = Pose::Identity();  ///< camera
};
/// On the move, by vision: the gyro's bias is what its turns differ by from the camera's; gravity
/// and the velocities are the solution of the linear equations that position and velocity
/// increments give (as Qin and Shen, "VINS-Mono", T-RO 2018, section V-B, with stereo's known
/// scale). `motions` follow each other without a gap. Nothing if they are too few or do not fit.
std::optional<Initial> initialise_by_vision(std::span<const ImuSample> samples,
                                            std::span<const TimedMotion> motions,
                                            const Pose& T_imu_cam, const ImuNoise& noise);

}  // namespace partita::fusion

#endif  // PARTITA_HOST_TASKS_FUSION_INITIALISE_H
