#include "host/tasks/sensing/scenario_motion.h"

namespace partita::sensing::scenario {

namespace {

constexpr double kTwoPi = 6.28318530717958647692;
constexpr double kGravity = 9.81;

struct Wave {
  double amplitude;
  double per_metre;  ///< radians
};
constexpr Wave kWaves[2] = {{6.0, kTwoPi / 220.0}, {1.2, kTwoPi / 90.0}};

/// What the springs do: amplitude * sin(rate * t), with its first two derivatives.
struct Sway {
  double value;
  double first;
  double second;
};
Sway sway(double amplitude, double rate, double t) {
  const double s = sine(rate * t);
  const double c = cosine(rate * t);
  return {amplitude * s, amplitude * rate * c, -amplitude * rate * rate * s};
}

Rotation multiply(const Rotation& a, const Rotation& b) {
  return {rotate(a, b.x), rotate(a, b.y), rotate(a, b.z)};
}

// Streams of random numbers.
enum : std::uint64_t { kPhase = 101, kGyroBias, kGyroNoise, kAccelBias, kAccelNoise, kGpsNoise };

constexpr double kGyroBiasLimit = 0.01;
constexpr double kGyroSigma = 0.002;
constexpr double kAccelBiasLimit = 0.1;
constexpr double kAccelSigma = 0.05;
constexpr double kGpsSigma = 0.8;

}  // namespace

Street::Street(std::uint64_t seed)
    : phase_{kTwoPi * uniform(seed, kPhase, 0), kTwoPi * uniform(seed, kPhase, 1)} {}

double Street::centre(double z) const {
  return kWaves[0].amplitude * sine(kWaves[0].per_metre * z + phase_[0]) +
         kWaves[1].amplitude * sine(kWaves[1].per_metre * z + phase_[1]);
}

double Street::slope(double z) const {
  return kWaves[0].amplitude * kWaves[0].per_metre * cosine(kWaves[0].per_metre * z + phase_[0]) +
         kWaves[1].amplitude * kWaves[1].per_metre * cosine(kWaves[1].per_metre * z + phase_[1]);
}

double Street::curvature(double z) const {
  const double k0 = kWaves[0].per_metre;
  const double k1 = kWaves[1].per_metre;
  return -(kWaves[0].amplitude * k0 * k0 * sine(k0 * z + phase_[0])) -
         kWaves[1].amplitude * k1 * k1 * sine(k1 * z + phase_[1]);
}

MotionState Motion::state(double t) const {
  const double z = kSpeed * t;
  const double slope = street_.slope(z);
  const double curvature = street_.curvature(z);
  const double stretch = 1.0 / std::sqrt(1.0 + slope * slope);
  const double yaw_rate = curvature * kSpeed * stretch * stretch;
  const Sway bounce = sway(0.008, 8.2, t);
  const Sway pitch = sway(0.0044, 6.9, t);
  const Sway roll = sway(0.0026, 5.3, t);

  const double sin_yaw = slope * stretch;
  const double cos_yaw = stretch;
  const double sin_pitch = sine(pitch.value);
  const double cos_pitch = cosine(pitch.value);
  const double sin_roll = sine(roll.value);
  const double cos_roll = cosine(roll.value);
  const Rotation yaw_R{{cos_yaw, 0, -sin_yaw}, {0, 1, 0}, {sin_yaw, 0, cos_yaw}};
  const Rotation pitch_R{{1, 0, 0}, {0, cos_pitch, sin_pitch}, {0, -sin_pitch, cos_pitch}};
  const Rotation roll_R{{cos_roll, sin_roll, 0}, {-sin_roll, cos_roll, 0}, {0, 0, 1}};

  MotionState s;
  s.position = {street_.centre(z) + kLane, -kCameraHeight + bounce.value, z};
  s.R_world_cam = multiply(multiply(yaw_R, pitch_R), roll_R);
  // d/dt (Ry Rx Rz): each rotation's own rate, turned back by the rotations inside it.
  const Vec3 yaw_part = rotate_back(pitch_R, Vec3{0, yaw_rate, 0});
  s.angular_velocity =
      Vec3{0, 0, roll.first} + rotate_back(roll_R, yaw_part + Vec3{pitch.first, 0, 0});
  const Vec3 acceleration{curvature * kSpeed * kSpeed, bounce.second, 0};
  s.specific_force = rotate_back(s.R_world_cam, acceleration - Vec3{0, kGravity, 0});
  return s;
}

ImuSample Motion::imu(std::int64_t k) const {
  ImuSample sample;
  sample.timestamp_ns = k * kImuPeriodNs;
  const MotionState s = state(static_cast<double>(sample.timestamp_ns) * 1e-9);
  const double gyro[3] = {s.angular_velocity.x, s.angular_velocity.y, s.angular_velocity.z};
  const double accel[3] = {s.specific_force.x, s.specific_force.y, s.specific_force.z};
  for (std::uint64_t i = 0; i < 3; ++i) {
    const double gyro_bias = kGyroBiasLimit * (2.0 * uniform(seed_, kGyroBias, i) - 1.0);
    const double accel_bias = kAccelBiasLimit * (2.0 * uniform(seed_, kAccelBias, i) - 1.0);
    const auto axis = static_cast<Eigen::Index>(i);
    sample.gyro[axis] = gyro[i] + gyro_bias + kGyroSigma * normal(seed_, kGyroNoise, key(k), i);
    sample.accel[axis] =
        accel[i] + accel_bias + kAccelSigma * normal(seed_, kAccelNoise, key(k), i);
  }
  return sample;
}

GpsFix Motion::gps(std::int64_t k) const {
  GpsFix fix;
  fix.timestamp_ns = k * kGpsPeriodNs;
  fix.sigma = kGpsSigma;
  const Vec3 d = state(static_cast<double>(fix.timestamp_ns) * 1e-9).position - state(0.0).position;
  const double true_position[3] = {d.x, d.z, -d.y};
  for (std::uint64_t i = 0; i < 3; ++i) {
    fix.position[static_cast<Eigen::Index>(i)] =
        true_position[i] + kGpsSigma * normal(seed_, kGpsNoise, key(k), i);
  }
  return fix;
}

Pose relative_pose(const MotionState& world, const MotionState& camera) {
  const Rotation& R = camera.R_world_cam;
  const Vec3 columns[4] = {rotate_back(world.R_world_cam, R.x), rotate_back(world.R_world_cam, R.y),
                           rotate_back(world.R_world_cam, R.z),
                           rotate_back(world.R_world_cam, camera.position - world.position)};
  Pose pose = Pose::Identity();
  for (int i = 0; i < 4; ++i) {
    pose.matrix().block<3, 1>(0, i) = Eigen::Vector3d(columns[i].x, columns[i].y, columns[i].z);
  }
  return pose;
}

}  // namespace partita::sensing::scenario
