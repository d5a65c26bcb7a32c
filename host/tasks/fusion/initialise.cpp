#include "host/tasks/fusion/initialise.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace partita::fusion {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kStillGyro = 0.02;      ///< rad/s
constexpr double kStillAccel = 0.15;     ///< m/s^2
constexpr double kSteadyGyro = 0.15;     ///< rad/s
constexpr double kSteadyAccel = 1.5;     ///< m/s^2
constexpr double kMostStillTurn = 0.15;  ///< mean rate, rad/s: a bias, no turn
constexpr double kFreeYaw = 0.5;         ///< nothing depends on where a local world points to
constexpr double kFreePosition = 10;     ///< nor on where its origin is
constexpr double kLeastSpeed = 1.5;      ///< below it a course says nothing, m/s
constexpr double kLeastCourseSeconds = 0.5;
constexpr double kMostSpeed = 90;  ///< between fixes, m/s: faster ones are outliers
constexpr std::size_t kLeastMotions = 8;

std::span<const ImuSample> within(std::span<const ImuSample> samples, std::int64_t from_ns,
                                  std::int64_t to_ns) {
  const auto before = [](const ImuSample& s, std::int64_t t) { return s.timestamp_ns < t; };
  const auto first = std::lower_bound(samples.begin(), samples.end(), from_ns, before);
  const auto last = std::lower_bound(first, samples.end(), to_ns + 1, before);
  return {first, last};
}

StateVector sigmas(double tilt, double yaw, double position, double velocity, double gyro,
                   double accel) {
  StateVector s;
  s << tilt, tilt, yaw, Vector3d::Constant(position), Vector3d::Constant(velocity),
      Vector3d::Constant(gyro), Vector3d::Constant(accel);
  return s;
}

/// Of the last fixes that follow each other without a jump.
std::span<const GpsFix> last_consistent(std::span<const GpsFix> fixes) {
  std::size_t first = fixes.empty() ? 0 : fixes.size() - 1;
  while (first > 0) {
    const GpsFix& a = fixes[first - 1];
    const GpsFix& b = fixes[first];
    const double most =
        kMostSpeed * seconds_between(a.timestamp_ns, b.timestamp_ns) + 4 * (a.sigma + b.sigma);
    if ((b.position - a.position).head<2>().norm() > most) break;
    --first;
  }
  return fixes.subspan(first);
}

/// Velocity over ground and how uncertain it is.
struct GroundVelocity {
  Vector3d velocity = Vector3d::Zero();
  double sigma = 0;
};

std::optional<GroundVelocity> ground_velocity(std::span<const GpsFix> fixes) {
  const GpsFix& last = fixes.back();
  const double span = seconds_between(fixes.front().timestamp_ns, last.timestamp_ns);
  if (last.speed && last.course) {
    if (*last.speed < kLeastSpeed || span < kLeastCourseSeconds) return std::nullopt;
    return GroundVelocity{*last.speed * Vector3d(std::sin(*last.course), std::cos(*last.course), 0),
                          0.5};
  }
  // A parabola in time through the last fixes: on a bend its slope at the end is the velocity then,
  // which a straight line's is not. Its standard deviation is about 9 sigma / (span sqrt(n)).
  const auto count = static_cast<Eigen::Index>(fixes.size());
  if (count < 5) return std::nullopt;
  Eigen::MatrixXd A(count, 3), b(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const GpsFix& fix = fixes[static_cast<std::size_t>(i)];
    const double t = seconds_between(last.timestamp_ns, fix.timestamp_ns);
    A.row(i) << 1, t, t * t;
    b.row(i) = fix.position.transpose();
  }
  const Eigen::MatrixXd fit = A.colPivHouseholderQr().solve(b);
  const Vector3d velocity = fit.row(1).transpose();
  const double sigma =
      9 * std::max(last.sigma, 0.1) / (span * std::sqrt(static_cast<double>(count)));
  if (velocity.head<2>().norm() < std::max(kLeastSpeed, 4 * sigma)) return std::nullopt;
  return GroundVelocity{velocity, std::max(sigma, 0.5)};
}

}  // namespace

Matrix3d level(const Vector3d& up) {
  const Matrix3d tilted = Eigen::Quaterniond::FromTwoVectors(up, Vector3d::UnitZ()).matrix();
  const Matrix3d R = so3::exp(Vector3d(0, 0, -so3::yaw(tilted))) * tilted;
  return so3::normalised(R);
}

Rest observe_rest(std::span<const ImuSample> samples) {
  Rest rest;
  if (samples.size() < 3) return rest;
  rest.seconds = seconds_between(samples.front().timestamp_ns, samples.back().timestamp_ns);
  const auto count = static_cast<double>(samples.size());
  for (const ImuSample& s : samples) {
    rest.mean_gyro += s.gyro / count;
    rest.mean_accel += s.accel / count;
  }
  double gyro = 0, accel = 0;
  for (const ImuSample& s : samples) {
    gyro += (s.gyro - rest.mean_gyro).squaredNorm() / count;
    accel += (s.accel - rest.mean_accel).squaredNorm() / count;
  }
  rest.gyro_deviation = std::sqrt(gyro);
  rest.accel_deviation = std::sqrt(accel);
  rest.steady = rest.seconds >= kRestSeconds && rest.gyro_deviation < kSteadyGyro &&
                rest.accel_deviation < kSteadyAccel && rest.mean_gyro.norm() < kMostStillTurn &&
                std::abs(rest.mean_accel.norm() - kGravity) < 0.1 * kGravity;
  rest.still =
      rest.steady && rest.gyro_deviation < kStillGyro && rest.accel_deviation < kStillAccel;
  return rest;
}

Initial initialise_at_rest(const Rest& rest, std::int64_t time_ns, const ImuNoise& noise) {
  Initial initial;
  const Vector3d up = rest.mean_accel.normalized();
  initial.state.timestamp_ns = time_ns;
  initial.state.R_world_imu = level(up);
  initial.state.bias.gyro = rest.mean_gyro;
  initial.state.bias.accel = rest.mean_accel - kGravity * up;
  initial.sigma = sigmas(noise.accel_bias / kGravity, kFreeYaw, kFreePosition, 0.05,
                         noise.gyro_density / std::sqrt(rest.seconds) + 1e-4, noise.accel_bias);
  return initial;
}

std::optional<Initial> initialise_by_gps(std::span<const ImuSample> samples,
                                         std::span<const GpsFix> all, const Matrix3d& R_imu_vehicle,
                                         const ImuNoise& noise, double velocity_lag_seconds) {
  const std::span<const GpsFix> fixes = last_consistent(all);
  if (fixes.size() < 2 || samples.empty()) return std::nullopt;
  const std::optional<GroundVelocity> moving = ground_velocity(fixes);
  if (!moving) return std::nullopt;
  const auto near = within(samples, fixes.front().timestamp_ns, fixes.back().timestamp_ns);
  if (near.empty()) return std::nullopt;
  Vector3d gyro = Vector3d::Zero(), accel = Vector3d::Zero();
  for (const ImuSample& s : near) {
    gyro += s.gyro / static_cast<double>(near.size());
    accel += s.accel / static_cast<double>(near.size());
  }
  const Vector3d ahead = R_imu_vehicle.col(0) * moving->velocity.norm();
  const Vector3d up = (accel - gyro.cross(ahead)).normalized();
  Initial initial;
  NavState& state = initial.state;
  state.timestamp_ns = fixes.back().timestamp_ns;
  state.position = fixes.back().position;
  state.velocity = moving->velocity;
  if (fixes.back().course) {
    state.velocity = so3::exp(Vector3d(0, 0, gyro.dot(up) * velocity_lag_seconds)) * state.velocity;
  }
  // Turn the levelled attitude so that the vehicle's nose points along the velocity.
  const Matrix3d levelled = level(up);
  const Vector3d nose = levelled * R_imu_vehicle.col(0);
  const double turn =
      std::atan2(state.velocity.y(), state.velocity.x()) - std::atan2(nose.y(), nose.x());
  state.R_world_imu = so3::normalised(so3::exp(Vector3d(0, 0, turn)) * levelled);
  const double yaw = std::min(0.5, moving->sigma / moving->velocity.head<2>().norm() + 2 * kDegree);
  // A car neither rolls nor pitches for long: what the gyro shows across the vertical is its bias.
  state.bias.gyro = gyro - gyro.dot(up) * up;
  initial.sigma = sigmas(4 * kDegree, yaw, std::max(fixes.back().sigma, 1.0), 2 * moving->sigma,
                         noise.gyro_bias, noise.accel_bias);
  initial.in_map = true;
  return initial;
}

std::optional<Initial> initialise_by_vision(std::span<const ImuSample> samples,
                                            std::span<const TimedMotion> motions,
                                            const Pose& T_imu_cam, const ImuNoise& noise) {
  if (motions.size() < kLeastMotions || samples.empty()) return std::nullopt;
  // The unit's motion in the first moment's axes, by vision.
  std::vector<Pose> T_first_imu{Pose::Identity()};
  Vector3d gyro_bias = Vector3d::Zero();
  double seconds = 0;
  for (const TimedMotion& motion : motions) {
    const Pose T = T_imu_cam * motion.T_from_to * T_imu_cam.inverse();
    Preintegration turned({}, noise);
    turned.integrate(samples, motion.from_ns, motion.to_ns);
    gyro_bias += so3::log(T.linear().transpose() * turned.R);
    seconds += turned.seconds();
    T_first_imu.push_back(T_first_imu.back() * T);
  }
  gyro_bias /= seconds;
  // Unknown: gravity (in the first moment's axes) and the velocity at each moment.
  const auto count = static_cast<Eigen::Index>(motions.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6 * count, 3 + 3 * (count + 1));
  Eigen::VectorXd b = Eigen::VectorXd::Zero(6 * count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    Preintegration step({gyro_bias, Vector3d::Zero()}, noise);
    step.integrate(samples, motions[i].from_ns, motions[i].to_ns);
    const double t = step.seconds();
    const Matrix3d& R = T_first_imu[i].linear();
    const Vector3d moved = T_first_imu[i + 1].translation() - T_first_imu[i].translation();
    A.block<3, 3>(6 * k, 0) = Matrix3d::Identity() * (t / 2);
    A.block<3, 3>(6 * k, 3 + 3 * k) = Matrix3d::Identity();
    b.segment<3>(6 * k) = (moved - R * step.p) / t;
    A.block<3, 3>(6 * k + 3, 0) = Matrix3d::Identity() * t;
    A.block<3, 3>(6 * k + 3, 3 + 3 * k) = Matrix3d::Identity();
    A.block<3, 3>(6 * k + 3, 6 + 3 * k) = -Matrix3d::Identity();
    b.segment<3>(6 * k + 3) = -(R * step.v);
  }
  const Eigen::VectorXd x = A.colPivHouseholderQr().solve(b);
  const Vector3d down = x.head<3>();
  if (!(std::abs(down.norm() - kGravity) < 0.15 * kGravity)) return std::nullopt;
  const Matrix3d R_world_first = level(-down.normalized());
  Initial initial;
  initial.state.timestamp_ns = motions.back().to_ns;
  initial.state.R_world_imu = so3::normalised(R_world_first * T_first_imu.back().linear());
  initial.state.position = R_world_first * T_first_imu.back().translation();
  initial.state.velocity = R_world_first * x.tail<3>();
  initial.state.bias.gyro = gyro_bias;
  initial.sigma = sigmas(3 * kDegree, kFreeYaw, kFreePosition, 0.3,
                         noise.gyro_density / std::sqrt(seconds) + 2e-3, noise.accel_bias);
  return initial;
}

}  // namespace partita::fusion
