// Inertial readings between two moments as one measurement, independent of where the vehicle was,
// how fast, and which way was down (Forster et al., "On-Manifold Preintegration for Real-Time
// Visual-Inertial Odometry", T-RO 2017).
//
// Between neighbouring readings the rates are taken as constant at their mean, and the specific
// force acts in the attitude of the step's middle. With w and a the mean readings less the bias, h
// the step, R, v, p the motion so far (as seen from the first moment, without gravity):
//   Rm = R exp(w h/2)      R' = R exp(w h)      v' = v + Rm a h      p' = p + v h + Rm a h^2/2
//
// Jacobians by the bias follow by the chain rule. A change d of the gyro's bias changes R to
// R exp(J d); so J' = exp(w h)^T J - Jr(w h) h (their equation 44, one step of it), and the same
// with h/2 for the middle, Jm. From Rm exp(Jm d) a = Rm a - Rm hat(a) Jm d:
//   dv'/dbg = dv/dbg - Rm hat(a) Jm h     dv'/dba = dv/dba - Rm h     and with h^2/2 for p.
// The covariance of (rotation, position, velocity) grows by the same derivatives: P' = F P F^T +
// G Q G^T, with white noise of density s giving the mean over a step a variance of s^2 / h.
#ifndef PARTITA_HOST_TASKS_FUSION_PREINTEGRATION_H
#define PARTITA_HOST_TASKS_FUSION_PREINTEGRATION_H

#include <cstdint>
#include <span>

#include "host/tasks/fusion/state.h"
#include "host/tasks/sensing/sensor_log.h"

namespace partita::fusion {

using sensing::ImuNoise;
using sensing::ImuSample;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

class Preintegration {
 public:
  Preintegration(const Bias& bias, const ImuNoise& noise) : bias_(bias), noise_(noise) {}

  /// One step of `seconds` with the mean readings over it. `blind`: the readings are a guess, as
  /// samples are missing; the motion may differ by what a vehicle's usual turning and braking are.
  void step(const Vector3d& gyro, const Vector3d& accel, double seconds, bool blind = false);

  /// All that lies between the two times. `samples` are in order of time; what is missing at the
  /// ends or in between is filled with the neighbours' mean, and counts as blind where the hole is
  /// more than kLongestHole times the usual step (0: the median of these samples').
  void integrate(std::span<const ImuSample> samples, std::int64_t from_ns, std::int64_t to_ns,
                 double usual_seconds = 0);

  double seconds() const { return seconds_; }
  double bridged_seconds() const { return bridged_; }  ///< without readings of their own
  const Bias& bias() const { return bias_; }
  const ImuNoise& noise() const { return noise_; }
  const Matrix9d& covariance() const { return covariance_; }  ///< (rotation, position, velocity)

  // The motion, and its derivatives by the bias.
  Matrix3d R = Matrix3d::Identity();
  Vector3d p = Vector3d::Zero();
  Vector3d v = Vector3d::Zero();
  Matrix3d dR_dgyro = Matrix3d::Zero();
  Matrix3d dp_dgyro = Matrix3d::Zero();
  Matrix3d dp_daccel = Matrix3d::Zero();
  Matrix3d dv_dgyro = Matrix3d::Zero();
  Matrix3d dv_daccel = Matrix3d::Zero();

  /// The motion at another bias, to first order (their equation 44).
  Matrix3d corrected_R(const Bias& bias) const {
    return R * so3::exp(dR_dgyro * (bias.gyro - bias_.gyro));
  }
  Vector3d corrected_p(const Bias& bias) const {
    return p + dp_dgyro * (bias.gyro - bias_.gyro) + dp_daccel * (bias.accel - bias_.accel);
  }
  Vector3d corrected_v(const Bias& bias) const {
    return v + dv_dgyro * (bias.gyro - bias_.gyro) + dv_daccel * (bias.accel - bias_.accel);
  }

  /// The state at the end of a motion that began at `from`, with the bias of `from`.
  NavState predict(const NavState& from) const;

  static constexpr double kLongestHole = 4;
  /// The median step between samples, in seconds.
  static double usual_step(std::span<const ImuSample> samples);

 private:
  Bias bias_;
  ImuNoise noise_;
  double seconds_ = 0;
  double bridged_ = 0;
  Matrix9d covariance_ = Matrix9d::Zero();
};

}  // namespace partita::fusion

#endif  // PARTITA_HOST_TASKS_FUSION_PREINTEGRATION_H
