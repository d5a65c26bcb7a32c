// How a logger's unit is mounted, from the drive itself: gravity says which axis is vertical, and
// the turns that GPS saw say which way along it is up.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/tasks/sensing/drive_csv.h"

namespace partita::sensing {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kVertical = 0.9;      ///< share of gravity that the vertical axis must show
constexpr double kCorrelation = 0.5;   ///< of the gyro's and the course's turns
constexpr double kBetweenFixes = 1.0;  ///< seconds over which a turn is measured
constexpr double kLeastSpeed = 2.0;    ///< m/s, for a course to mean something
constexpr double kLeastTurn = 0.02;    ///< rad/s, root mean square: less is no turning

/// Where a fix says that the vehicle moves to: its own course, or the direction to a later one.
std::optional<double> course_at(const std::vector<GpsFix>& fixes, std::size_t i, std::size_t next) {
  if (fixes[i].course && fixes[i].speed.value_or(0) > kLeastSpeed) return fixes[i].course;
  const Eigen::Vector3d d = fixes[next].position - fixes[i].position;
  if (d.head<2>().norm() < std::max(5.0, 5 * fixes[i].sigma)) return std::nullopt;
  return std::atan2(d.x(), d.y());
}

/// Correlation of turning to the left, by GPS, with an axis of the gyro; 0 where hardly any.
double turn_correlation(const SensorLog& log, int axis) {
  std::vector<double> turns, rates;
  std::size_t sample = 0;
  for (std::size_t i = 0; i < log.gps.size();) {
    std::size_t j = i + 1, k;
    const auto apart = [&](std::size_t a, std::size_t b) {
      return static_cast<double>(log.gps[b].timestamp_ns - log.gps[a].timestamp_ns) * 1e-9;
    };
    while (j < log.gps.size() && apart(i, j) < kBetweenFixes) ++j;
    for (k = j; k < log.gps.size() && apart(j, k) < kBetweenFixes;) ++k;
    if (k >= log.gps.size()) break;
    const auto before = course_at(log.gps, i, j), after = course_at(log.gps, j, k);
    double sum = 0;
    std::size_t count = 0;
    while (sample < log.imu.size() && log.imu[sample].timestamp_ns < log.gps[i].timestamp_ns)
      ++sample;
    for (; sample < log.imu.size() && log.imu[sample].timestamp_ns < log.gps[j].timestamp_ns;
         ++sample, ++count) {
      sum += log.imu[sample].gyro[axis];
    }
    if (before && after && count > 0) {
      turns.push_back(-std::remainder(*after - *before, 2 * kPi) / apart(i, j));
      rates.push_back(sum / static_cast<double>(count));
    }
    i = j;
  }
  if (turns.size() < 5) return 0;
  const auto n = static_cast<double>(turns.size());
  double mean_t = 0, mean_r = 0, tt = 0, rr = 0, tr = 0;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    mean_t += turns[i] / n;
    mean_r += rates[i] / n;
  }
  for (std::size_t i = 0; i < turns.size(); ++i) {
    tt += (turns[i] - mean_t) * (turns[i] - mean_t) / n;
    rr += (rates[i] - mean_r) * (rates[i] - mean_r) / n;
    tr += (turns[i] - mean_t) * (rates[i] - mean_r) / n;
  }
  if (std::sqrt(tt) < kLeastTurn || !(rr > 0)) return 0;
  return tr / std::sqrt(tt * rr);
}

}  // namespace

void settle_conventions(SensorLog& log) {
  if (log.imu.empty() || log.gps.empty()) return;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const ImuSample& s : log.imu) mean += s.accel / static_cast<double>(log.imu.size());
  Eigen::Index axis = 0;
  if (!(mean.cwiseAbs().maxCoeff(&axis) > kVertical * mean.norm()) || axis != 2) {
    log.notices.push_back(
        "the unit's z axis is not vertical: nothing is known of where the vehicle's nose is, "
        "wheels "
        "do not count");
    return;
  }
  const double turning = turn_correlation(log, 2);
  const bool known = std::abs(turning) > kCorrelation;
  const double up = known ? (turning > 0 ? 1 : -1) : (mean.z() > 0 ? 1 : -1);
  if (up * mean.z() < 0) {
    for (ImuSample& s : log.imu) s.accel = -s.accel;
    log.notices.push_back(fmt::format(
        "the accelerometer shows gravity ({:+.2f} m/s^2 along z) instead of the force against it: "
        "turned round (the gyro's z axis points {} by the turns that GPS saw, correlation {:.2f})",
        mean.z(), up > 0 ? "up" : "down", turning));
  }
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  if (up < 0) R.diagonal() << 1, -1, -1;  // forward, right, down
  log.R_imu_vehicle = R;
}

void measure_noise(SensorLog& log) {
  if (log.imu.size() < 100) return;
  std::vector<double> gyro, accel;
  for (std::size_t i = 1; i < log.imu.size(); ++i) {
    gyro.push_back((log.imu[i].gyro - log.imu[i - 1].gyro).norm());
    accel.push_back((log.imu[i].accel - log.imu[i - 1].accel).norm());
  }
  const double seconds =
      static_cast<double>(log.imu.back().timestamp_ns - log.imu.front().timestamp_ns) * 1e-9 /
      static_cast<double>(log.imu.size() - 1);
  const auto density = [seconds](std::vector<double>& steps) {
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    // The median length of a difference of two readings, in three dimensions, is 1.54 sqrt(2)
    // sigma.
    return 4 * *middle / (1.54 * std::sqrt(2.0)) * std::sqrt(seconds);
  };
  constexpr double kLeastGyro = 1e-4, kLeastAccel = 2e-3;  // no unit is better than that in use
  log.noise.gyro_density = std::max(kLeastGyro, density(gyro));
  log.noise.accel_density = std::max(kLeastAccel, density(accel));
}

}  // namespace partita::sensing
