// Factors that are linear in the states' changes: priors.
#include <utility>

#include "host/tasks/fusion/factors.h"

namespace partita::fusion {
namespace {

class LinearFactor final : public Factor {
 public:
  LinearFactor(std::vector<StateId> ids, std::vector<NavState> at, Eigen::VectorXd r,
               Eigen::MatrixXd J)
      : ids_(std::move(ids)), at_(std::move(at)), r_(std::move(r)), J_(std::move(J)) {}

  const std::vector<StateId>& states() const override { return ids_; }
  Eigen::VectorXd residual(const States& states,
                           std::vector<StateJacobian>* jacobians) const override {
    Eigen::VectorXd r = r_;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      r += block(i) * states.at(ids_[i]).minus(at_[i]);
    }
    if (jacobians != nullptr) {
      jacobians->clear();
      for (std::size_t i = 0; i < ids_.size(); ++i) jacobians->emplace_back(block(i));
    }
    return r;
  }

  /// Positions and velocities are in the world's axes, all else is in the unit's.
  FactorPtr moved(const Pose& T_new_old) const {
    std::vector<NavState> at = at_;
    Eigen::MatrixXd J = J_;
    const Matrix3d back = T_new_old.linear().transpose();
    for (std::size_t i = 0; i < at.size(); ++i) {
      at[i].R_world_imu = T_new_old.linear() * at[i].R_world_imu;
      at[i].position = T_new_old * at[i].position;
      at[i].velocity = T_new_old.linear() * at[i].velocity;
      for (const int part : {kPosition, kVelocity}) {
        const auto columns = static_cast<Eigen::Index>(i) * kStateSize + part;
        J.middleCols<3>(columns) = (J.middleCols<3>(columns) * back).eval();
      }
    }
    return std::make_shared<LinearFactor>(ids_, std::move(at), r_, std::move(J));
  }

 private:
  Eigen::MatrixXd block(std::size_t i) const {
    return J_.middleCols(static_cast<Eigen::Index>(i) * kStateSize, kStateSize);
  }

  std::vector<StateId> ids_;
  std::vector<NavState> at_;
  Eigen::VectorXd r_;
  Eigen::MatrixXd J_;
};

}  // namespace

FactorPtr linear_factor(std::vector<StateId> ids, std::vector<NavState> at, Eigen::VectorXd r,
                        Eigen::MatrixXd J) {
  return std::make_shared<LinearFactor>(std::move(ids), std::move(at), std::move(r), std::move(J));
}

FactorPtr moved_factor(const FactorPtr& factor, const Pose& T_new_old) {
  const auto* linear = dynamic_cast<const LinearFactor*>(factor.get());
  return linear == nullptr ? factor : linear->moved(T_new_old);
}

FactorPtr prior_factor(StateId id, const NavState& at, const StateVector& sigma) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(kStateSize, kStateSize);
  for (int i = 0; i < kStateSize; ++i) J(i, i) = sigma[i] > 0 ? 1 / sigma[i] : 0;
  // The change of rotation is in the unit's axes: R d is the same turn in the world's.
  J.topLeftCorner<3, 3>() = (J.topLeftCorner<3, 3>() * at.R_world_imu).eval();
  return linear_factor({id}, {at}, Eigen::VectorXd::Zero(kStateSize), std::move(J));
}

}  // namespace partita::fusion
