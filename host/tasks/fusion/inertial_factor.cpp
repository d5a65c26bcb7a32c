// The inertial factor. With dt the time, g gravity, and R~ v~ p~ the measured motion at the bias of
// the first state (Forster et al., equation 45):
//   r_R = log(R~^T Ri^T Rj)   r_p = Ri^T (pj - pi - vi dt - g dt^2/2) - p~
//   r_v = Ri^T (vj - vi - g dt) - v~
// Derivatives (their appendix C): with Ri exp(d), Ri^T x becomes Ri^T x + hat(Ri^T x) d, and
//   dr_R/di = -Jr^-1(r_R) Rj^T Ri    dr_R/dj = Jr^-1(r_R)
//   dr_R/dbg = -Jr^-1(r_R) exp(r_R)^T Jr(dR/dbg (bg - bg0)) dR/dbg.
#include <Eigen/Cholesky>

#include "host/tasks/fusion/factors.h"

namespace partita::fusion {
namespace {

class InertialFactor final : public Factor {
 public:
  InertialFactor(StateId from, const Preintegration& measured)
      : ids_{from, from + 1}, measured_(measured) {
    StateMatrix covariance = StateMatrix::Zero();
    covariance.topLeftCorner<9, 9>() = measured.covariance();
    const double t = measured.seconds();
    const ImuNoise& noise = measured.noise();
    // Far below any sensor's noise: keeps a single step's covariance, which has rank 6, invertible.
    covariance.diagonal().head<3>().array() += 1e-14;
    covariance.diagonal().segment<3>(kPosition).array() += 1e-10;
    covariance.diagonal().segment<3>(kVelocity).array() += 1e-10;
    covariance.diagonal().segment<3>(kGyroBias).array() = noise.gyro_walk * noise.gyro_walk * t;
    covariance.diagonal().segment<3>(kAccelBias).array() = noise.accel_walk * noise.accel_walk * t;
    const Eigen::LLT<StateMatrix> llt(covariance);
    whitening_ = llt.matrixL().solve(StateMatrix::Identity());
  }
  const std::vector<StateId>& states() const override { return ids_; }
  Eigen::VectorXd residual(const States& states,
                           std::vector<StateJacobian>* jacobians) const override {
    StateMatrix by_from, by_to;
    const bool wanted = jacobians != nullptr;
    const StateVector r = inertial_residual(states.at(ids_[0]), states.at(ids_[1]), measured_,
                                            wanted ? &by_from : nullptr, wanted ? &by_to : nullptr);
    if (wanted) *jacobians = {whitening_ * by_from, whitening_ * by_to};
    return whitening_ * r;
  }

 private:
  std::vector<StateId> ids_;
  Preintegration measured_;
  StateMatrix whitening_;
};

}  // namespace

StateVector inertial_residual(const NavState& from, const NavState& to,
                              const Preintegration& measured, StateMatrix* by_from,
                              StateMatrix* by_to) {
  const double t = measured.seconds();
  const Matrix3d Ri_inverse = from.R_world_imu.transpose();
  const Vector3d moved =
      Ri_inverse * (to.position - from.position - from.velocity * t - gravity() * (t * t / 2));
  const Vector3d sped_up = Ri_inverse * (to.velocity - from.velocity - gravity() * t);
  StateVector r;
  r << so3::log(measured.corrected_R(from.bias).transpose() * Ri_inverse * to.R_world_imu),
      moved - measured.corrected_p(from.bias), sped_up - measured.corrected_v(from.bias),
      to.bias.gyro - from.bias.gyro, to.bias.accel - from.bias.accel;
  if (by_from == nullptr || by_to == nullptr) return r;

  const Vector3d r_R = r.segment<3>(kRotation);
  const Matrix3d J_inverse = so3::inverse_right_jacobian(r_R);
  const Vector3d bias_turn = measured.dR_dgyro * (from.bias.gyro - measured.bias().gyro);
  StateMatrix& i = *by_from;
  StateMatrix& j = *by_to;
  i.setZero();
  j.setZero();
  i.block<3, 3>(kRotation, kRotation) = -J_inverse * to.R_world_imu.transpose() * from.R_world_imu;
  j.block<3, 3>(kRotation, kRotation) = J_inverse;
  i.block<3, 3>(kRotation, kGyroBias) =
      -J_inverse * so3::exp(r_R).transpose() * so3::right_jacobian(bias_turn) * measured.dR_dgyro;
  i.block<3, 3>(kPosition, kRotation) = so3::hat(moved);
  i.block<3, 3>(kPosition, kPosition) = -Ri_inverse;
  j.block<3, 3>(kPosition, kPosition) = Ri_inverse;
  i.block<3, 3>(kPosition, kVelocity) = -Ri_inverse * t;
  i.block<3, 3>(kPosition, kGyroBias) = -measured.dp_dgyro;
  i.block<3, 3>(kPosition, kAccelBias) = -measured.dp_daccel;
  i.block<3, 3>(kVelocity, kRotation) = so3::hat(sped_up);
  i.block<3, 3>(kVelocity, kVelocity) = -Ri_inverse;
  j.block<3, 3>(kVelocity, kVelocity) = Ri_inverse;
  i.block<3, 3>(kVelocity, kGyroBias) = -measured.dv_dgyro;
  i.block<3, 3>(kVelocity, kAccelBias) = -measured.dv_daccel;
  i.block<6, 6>(kGyroBias, kGyroBias) = -Matrix6d::Identity();
  j.block<6, 6>(kGyroBias, kGyroBias) = Matrix6d::Identity();
  return r;
}

FactorPtr inertial_factor(StateId from, const Preintegration& measured) {
  return std::make_shared<InertialFactor>(from, measured);
}

}  // namespace partita::fusion
