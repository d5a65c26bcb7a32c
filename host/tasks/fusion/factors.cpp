#include "host/tasks/fusion/factors.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace partita::fusion {
namespace {

/// Half of the residuals of a normal error are within 1.2 of this length in three dimensions.
constexpr double kHuber = 2.5;

/// A factor of one state, of `Rows` residuals.
template <int Rows>
class SingleFactor : public Factor {
 public:
  using Residual = Eigen::Matrix<double, Rows, 1>;
  using Jacobian = Eigen::Matrix<double, Rows, kStateSize>;

  explicit SingleFactor(StateId id) : ids_{id} {}
  const std::vector<StateId>& states() const override { return ids_; }
  Eigen::VectorXd residual(const States& states,
                           std::vector<StateJacobian>* jacobians) const override {
    Jacobian J = Jacobian::Zero();
    const Residual r = evaluate(states.at(ids_[0]), J);
    if (jacobians != nullptr) *jacobians = {StateJacobian(J)};
    return r;
  }

 protected:
  virtual Residual evaluate(const NavState& state, Jacobian& J) const = 0;

 private:
  std::vector<StateId> ids_;
};

class PositionFactor final : public SingleFactor<3> {
 public:
  PositionFactor(StateId id, const PositionFix& fix) : SingleFactor(id), fix_(fix) {}
  double huber() const override { return kHuber; }

 private:
  Residual evaluate(const NavState& state, Jacobian& J) const override {
    const Vector3d weight(1 / fix_.sigma, 1 / fix_.sigma, 1 / fix_.sigma_up);
    J.block<3, 3>(0, kPosition) = weight.asDiagonal();
    J.block<3, 3>(0, kVelocity) = weight.asDiagonal();
    J.block<3, 3>(0, kVelocity) *= fix_.seconds;
    return weight.cwiseProduct(state.position + state.velocity * fix_.seconds - fix_.position);
  }
  PositionFix fix_;
};

class GroundVelocityFactor final : public SingleFactor<2> {
 public:
  GroundVelocityFactor(StateId id, const Eigen::Vector2d& velocity, double along, double across)
      : SingleFactor(id), velocity_(velocity) {
    const double speed = velocity.norm();
    const Eigen::Vector2d ahead =
        speed > 0 ? Eigen::Vector2d(velocity / speed) : Eigen::Vector2d(1, 0);
    whitening_ << ahead.x() / along, ahead.y() / along, -ahead.y() / across, ahead.x() / across;
  }
  double huber() const override { return kHuber; }

 private:
  Residual evaluate(const NavState& state, Jacobian& J) const override {
    J.block<2, 2>(0, kVelocity) = whitening_;
    return whitening_ * (state.velocity.head<2>() - velocity_);
  }
  Eigen::Vector2d velocity_;
  Eigen::Matrix2d whitening_;
};

class StandstillFactor final : public SingleFactor<6> {
 public:
  StandstillFactor(StateId id, const Vector3d& mean_gyro, double velocity, double gyro)
      : SingleFactor(id), mean_gyro_(mean_gyro), velocity_(velocity), gyro_(gyro) {}

 private:
  Residual evaluate(const NavState& state, Jacobian& J) const override {
    J.block<3, 3>(0, kVelocity) = Matrix3d::Identity() / velocity_;
    J.block<3, 3>(3, kGyroBias) = Matrix3d::Identity() / gyro_;
    Residual r;
    r << state.velocity / velocity_, (state.bias.gyro - mean_gyro_) / gyro_;
    return r;
  }
  Vector3d mean_gyro_;
  double velocity_, gyro_;
};

/// With V = R_world_vehicle: the velocity in the vehicle's axes is V^T v, and the world's vertical
/// there is V^T z, whose first two components are the sines of climbing and leaning.
class WheelFactor final : public SingleFactor<5> {
 public:
  WheelFactor(StateId id, const WheelConstraint& constraint)
      : SingleFactor(id), constraint_(constraint) {}
  double huber() const override { return kHuber; }

 private:
  Residual evaluate(const NavState& state, Jacobian& J) const override {
    const Matrix3d to_vehicle = constraint_.R_imu_vehicle.transpose();
    const Vector3d v_imu = state.R_world_imu.transpose() * state.velocity;
    const Vector3d up_imu = state.R_world_imu.transpose() * Vector3d::UnitZ();
    const Vector3d v = to_vehicle * v_imu;
    const Vector3d up = to_vehicle * up_imu;
    const Matrix3d v_by_turn = to_vehicle * so3::hat(v_imu);
    const Matrix3d up_by_turn = to_vehicle * so3::hat(up_imu);
    const Matrix3d v_by_v = to_vehicle * state.R_world_imu.transpose();
    const double weights[2] = {1 / constraint_.sigma_sideways, 1 / constraint_.sigma_up};
    Residual r;
    for (int i = 0; i < 2; ++i) {
      r[i] = v[1 + i] * weights[i];
      J.block<1, 3>(i, kRotation) = v_by_turn.row(1 + i) * weights[i];
      J.block<1, 3>(i, kVelocity) = v_by_v.row(1 + i) * weights[i];
      r[2 + i] = up[i] / constraint_.sigma_tilt;
      J.block<1, 3>(2 + i, kRotation) = up_by_turn.row(i) / constraint_.sigma_tilt;
    }
    r[4] = state.velocity.z() / constraint_.sigma_climb;
    J(4, kVelocity + 2) = 1 / constraint_.sigma_climb;
    return r;
  }
  WheelConstraint constraint_;
};

class SteadyFactor final : public Factor {
 public:
  SteadyFactor(StateId from, const WheelConstraint& constraint, double seconds)
      : ids_{from, from + 1},
        nose_(constraint.R_imu_vehicle.col(0)),
        sigma_(constraint.speed_walk * std::sqrt(seconds)) {}
  const std::vector<StateId>& states() const override { return ids_; }
  double huber() const override { return kHuber; }
  Eigen::VectorXd residual(const States& states,
                           std::vector<StateJacobian>* jacobians) const override {
    if (jacobians != nullptr) jacobians->assign(2, StateJacobian::Zero(1, kStateSize));
    double change = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      const NavState& s = states.at(ids_[i]);
      const Vector3d v_imu = s.R_world_imu.transpose() * s.velocity;
      const double sign = i == 0 ? -1 : 1;
      change += sign * nose_.dot(v_imu);
      if (jacobians == nullptr) continue;
      StateJacobian& J = (*jacobians)[i];
      J.block<1, 3>(0, kRotation) = sign / sigma_ * nose_.transpose() * so3::hat(v_imu);
      J.block<1, 3>(0, kVelocity) = sign / sigma_ * (s.R_world_imu * nose_).transpose();
    }
    return Eigen::VectorXd::Constant(1, change / sigma_);
  }

 private:
  std::vector<StateId> ids_;
  Vector3d nose_;
  double sigma_;
};

/// With Ci = Ri Rc the camera's attitude and ci its place: the motion expected is
/// E = Ci^T Cj, e = Ci^T (cj - ci); the residual is (log(M^T E), M^T (e - m)) for the measured M,
/// m.
class VisualFactor final : public Factor {
 public:
  VisualFactor(StateId from, StateId to, const VisualMotion& motion, const Pose& T_imu_cam)
      : ids_{from, to}, motion_(motion), T_imu_cam_(T_imu_cam) {
    whitening_ = motion.information.llt().matrixU();
  }
  const std::vector<StateId>& states() const override { return ids_; }
  double huber() const override { return 2 * kHuber; }
  Eigen::VectorXd residual(const States& states,
                           std::vector<StateJacobian>* jacobians) const override {
    const NavState& i = states.at(ids_[0]);
    const NavState& j = states.at(ids_[1]);
    const Matrix3d Rc = T_imu_cam_.linear();
    const Vector3d tc = T_imu_cam_.translation();
    const Matrix3d Ci_inverse = (i.R_world_imu * Rc).transpose();
    const Vector3d apart = j.R_world_imu * tc + j.position - i.R_world_imu * tc - i.position;
    const Matrix3d M_inverse = motion_.T_from_to.linear().transpose();
    Eigen::Matrix<double, 6, 1> r;
    r.head<3>() = so3::log(M_inverse * Ci_inverse * j.R_world_imu * Rc);
    r.tail<3>() = M_inverse * (Ci_inverse * apart - motion_.T_from_to.translation());
    if (jacobians != nullptr) {
      const Matrix3d J_inverse = so3::inverse_right_jacobian(r.head<3>());
      Eigen::Matrix<double, 6, kStateSize> Ji, Jj;
      Ji.setZero();
      Jj.setZero();
      Ji.block<3, 3>(0, kRotation) = -J_inverse * (j.R_world_imu * Rc).transpose() * i.R_world_imu;
      Jj.block<3, 3>(0, kRotation) = J_inverse * Rc.transpose();
      const Matrix3d by_world = M_inverse * Ci_inverse;
      Ji.block<3, 3>(3, kRotation) =
          M_inverse * Rc.transpose() * so3::hat(i.R_world_imu.transpose() * apart) +
          by_world * i.R_world_imu * so3::hat(tc);
      Jj.block<3, 3>(3, kRotation) = -by_world * j.R_world_imu * so3::hat(tc);
      Ji.block<3, 3>(3, kPosition) = -by_world;
      Jj.block<3, 3>(3, kPosition) = by_world;
      *jacobians = {StateJacobian(whitening_ * Ji), StateJacobian(whitening_ * Jj)};
    }
    return whitening_ * r;
  }

 private:
  std::vector<StateId> ids_;
  VisualMotion motion_;
  Pose T_imu_cam_;
  Matrix6d whitening_;
};

}  // namespace

FactorPtr position_factor(StateId id, const PositionFix& fix) {
  return std::make_shared<PositionFactor>(id, fix);
}

FactorPtr ground_velocity_factor(StateId id, const Eigen::Vector2d& velocity, double sigma_along,
                                 double sigma_across) {
  return std::make_shared<GroundVelocityFactor>(id, velocity, sigma_along, sigma_across);
}

FactorPtr visual_factor(StateId from, StateId to, const VisualMotion& motion,
                        const Pose& T_imu_cam) {
  return std::make_shared<VisualFactor>(from, to, motion, T_imu_cam);
}

FactorPtr standstill_factor(StateId id, const Vector3d& mean_gyro, double sigma_velocity,
                            double sigma_gyro) {
  return std::make_shared<StandstillFactor>(id, mean_gyro, sigma_velocity, sigma_gyro);
}

FactorPtr steady_factor(StateId from, const WheelConstraint& constraint, double seconds) {
  return std::make_shared<SteadyFactor>(from, constraint, seconds);
}

FactorPtr wheel_factor(StateId id, const WheelConstraint& constraint) {
  return std::make_shared<WheelFactor>(id, constraint);
}

}  // namespace partita::fusion
