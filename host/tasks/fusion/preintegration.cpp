#include "host/tasks/fusion/preintegration.h"

#include <algorithm>
#include <vector>

namespace partita::fusion {
namespace {

/// What the readings may be off by where there are none: a car's usual turning and braking.
constexpr double kBlindGyro = 0.2;   ///< rad/s
constexpr double kBlindAccel = 2.0;  ///< m/s^2

ImuSample between(const ImuSample& a, const ImuSample& b, std::int64_t time_ns) {
  const double share =
      seconds_between(a.timestamp_ns, time_ns) / seconds_between(a.timestamp_ns, b.timestamp_ns);
  ImuSample s;
  s.timestamp_ns = time_ns;
  s.gyro = a.gyro + share * (b.gyro - a.gyro);
  s.accel = a.accel + share * (b.accel - a.accel);
  return s;
}

/// The reading at a time: between its neighbours, or the nearest where there is only one.
ImuSample at(std::span<const ImuSample> samples, std::int64_t time_ns) {
  const auto next =
      std::lower_bound(samples.begin(), samples.end(), time_ns,
                       [](const ImuSample& s, std::int64_t t) { return s.timestamp_ns < t; });
  if (next != samples.end() && next->timestamp_ns == time_ns) return *next;
  if (next != samples.begin() && next != samples.end()) return between(*(next - 1), *next, time_ns);
  ImuSample s = next == samples.end() ? samples.back() : samples.front();
  s.timestamp_ns = time_ns;
  return s;
}

/// How far apart the readings before and after the end of a step are.
double hole_around(std::span<const ImuSample> samples, std::int64_t end_ns) {
  const auto next =
      std::lower_bound(samples.begin(), samples.end(), end_ns,
                       [](const ImuSample& s, std::int64_t t) { return s.timestamp_ns < t; });
  if (next == samples.end()) return seconds_between(samples.back().timestamp_ns, end_ns);
  if (next == samples.begin()) return seconds_between(end_ns, samples.front().timestamp_ns);
  return seconds_between((next - 1)->timestamp_ns, next->timestamp_ns);
}

}  // namespace

double Preintegration::usual_step(std::span<const ImuSample> samples) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    steps.push_back(seconds_between(samples[i - 1].timestamp_ns, samples[i].timestamp_ns));
  }
  if (steps.empty()) return 0.01;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

void Preintegration::step(const Vector3d& gyro, const Vector3d& accel, double h, bool blind) {
  const Vector3d w = gyro - bias_.gyro;
  const Vector3d a = accel - bias_.accel;
  const Matrix3d turn = so3::exp(w * h);
  const Matrix3d half_turn = so3::exp(w * (h / 2));
  const Matrix3d Rm = R * half_turn;
  const Matrix3d Jr = so3::right_jacobian(w * h) * h;
  const Matrix3d Jr_half = so3::right_jacobian(w * (h / 2)) * (h / 2);
  const Matrix3d dRm_dgyro = half_turn.transpose() * dR_dgyro - Jr_half;
  const Matrix3d Rm_a = Rm * so3::hat(a);

  Matrix9d F = Matrix9d::Identity();  // (rotation, position, velocity)
  F.block<3, 3>(0, 0) = turn.transpose();
  F.block<3, 3>(3, 0) = -Rm_a * half_turn.transpose() * (h * h / 2);
  F.block<3, 3>(3, 6) = Matrix3d::Identity() * h;
  F.block<3, 3>(6, 0) = -Rm_a * half_turn.transpose() * h;
  Eigen::Matrix<double, 9, 3> by_gyro, by_accel;
  by_gyro << Jr, -Rm_a * Jr_half * (h * h / 2), -Rm_a * Jr_half * h;
  by_accel << Matrix3d::Zero(), Rm * (h * h / 2), Rm * h;
  double gyro_variance = noise_.gyro_density * noise_.gyro_density / h;
  double accel_variance = noise_.accel_density * noise_.accel_density / h;
  if (blind) {
    gyro_variance += kBlindGyro * kBlindGyro;
    accel_variance += kBlindAccel * kBlindAccel;
    bridged_ += h;
  }
  covariance_ = F * covariance_ * F.transpose() + gyro_variance * by_gyro * by_gyro.transpose() +
                accel_variance * by_accel * by_accel.transpose();

  dp_dgyro += dv_dgyro * h - Rm_a * dRm_dgyro * (h * h / 2);
  dp_daccel += dv_daccel * h - Rm * (h * h / 2);
  dv_dgyro -= Rm_a * dRm_dgyro * h;
  dv_daccel -= Rm * h;
  dR_dgyro = turn.transpose() * dR_dgyro - Jr;
  p += v * h + Rm * a * (h * h / 2);
  v += Rm * a * h;
  R = so3::normalised(R * turn);
  seconds_ += h;
}

void Preintegration::integrate(std::span<const ImuSample> samples, std::int64_t from_ns,
                               std::int64_t to_ns, double usual_seconds) {
  if (to_ns <= from_ns) return;
  if (samples.empty()) {
    step(bias_.gyro, bias_.accel, seconds_between(from_ns, to_ns), true);
    return;
  }
  const double longest = kLongestHole * (usual_seconds > 0 ? usual_seconds : usual_step(samples));
  std::vector<ImuSample> nodes{at(samples, from_ns)};
  for (const ImuSample& s : samples) {
    if (s.timestamp_ns > from_ns && s.timestamp_ns < to_ns) nodes.push_back(s);
  }
  nodes.push_back(at(samples, to_ns));
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const ImuSample& a = nodes[i - 1];
    const ImuSample& b = nodes[i];
    const double hole = hole_around(samples, b.timestamp_ns);
    step(0.5 * (a.gyro + b.gyro), 0.5 * (a.accel + b.accel),
         seconds_between(a.timestamp_ns, b.timestamp_ns), hole > longest);
  }
}

NavState Preintegration::predict(const NavState& from) const {
  NavState to = from;
  to.timestamp_ns = from.timestamp_ns + static_cast<std::int64_t>(std::llround(seconds_ * 1e9));
  to.R_world_imu = so3::normalised(from.R_world_imu * corrected_R(from.bias));
  to.velocity = from.velocity + gravity() * seconds_ + from.R_world_imu * corrected_v(from.bias);
  to.position = from.position + from.velocity * seconds_ + gravity() * (seconds_ * seconds_ / 2) +
                from.R_world_imu * corrected_p(from.bias);
  return to;
}

}  // namespace partita::fusion
