// The measurements that fusion knows. All are whitened; derivatives are by NavState::plus's change.
#ifndef PARTITA_HOST_TASKS_FUSION_FACTORS_H
#define PARTITA_HOST_TASKS_FUSION_FACTORS_H

#include <optional>

#include "host/tasks/fusion/factor.h"
#include "host/tasks/fusion/preintegration.h"

namespace partita::fusion {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using sensing::Pose;

/// Inertial readings between a state and the next (Forster et al., equation 45), and the random
/// walk of the biases meanwhile. 15 residuals: rotation, position, velocity, gyro's and
/// accelerometer's bias.
FactorPtr inertial_factor(StateId from, const Preintegration& measured);

/// Its residual before whitening, for tests: the same order.
StateVector inertial_residual(const NavState& from, const NavState& to,
                              const Preintegration& measured, StateMatrix* by_from = nullptr,
                              StateMatrix* by_to = nullptr);

/// Keeps a state where it is: standard deviations of its 15 changes, those of the rotation about
/// the world's axes (tilt about x and y, yaw about z); 0 for no say.
FactorPtr prior_factor(StateId id, const NavState& at, const StateVector& sigma);

/// A quadratic form over several states, what marginalisation leaves of older ones: the residual is
/// r + J (x - at), with one block of columns of J for each state.
FactorPtr linear_factor(std::vector<StateId> ids, std::vector<NavState> at, Eigen::VectorXd r,
                        Eigen::MatrixXd J);
/// The same in a world that is turned about the vertical and shifted. Factors other than linear
/// ones that do not speak of the world are returned as they are.
FactorPtr moved_factor(const FactorPtr& factor, const Pose& T_new_old);

/// A position fix `seconds` after the state (before: negative), at most a fraction of a second.
struct PositionFix {
  Vector3d position;  ///< of the inertial unit in the world
  double seconds = 0;
  double sigma = 1;     ///< of east and of north, metres
  double sigma_up = 3;  ///< metres
};
FactorPtr position_factor(StateId id, const PositionFix& fix);

/// Velocity over ground, by GPS: east and north.
FactorPtr ground_velocity_factor(StateId id, const Eigen::Vector2d& velocity, double sigma_along,
                                 double sigma_across);

/// The camera's motion between two states as vision saw it. `information` is the inverse of the
/// covariance of (rotation, translation) of T_from_to changed on its right.
struct VisualMotion {
  Pose T_from_to = Pose::Identity();  ///< camera at `to` in the axes of the camera at `from`
  Matrix6d information = Matrix6d::Identity();
};
FactorPtr visual_factor(StateId from, StateId to, const VisualMotion& motion,
                        const Pose& T_imu_cam);

/// Standing still: no velocity, and the gyro's mean reading is its bias.
FactorPtr standstill_factor(StateId id, const Vector3d& mean_gyro, double sigma_velocity,
                            double sigma_gyro);

/// A vehicle on wheels moves neither sideways nor up in its own axes; roads are nearly level, and
/// drivers keep their speed. The last two hold speed and attitude while nothing else does: they are
/// weak, and what an accelerometer whose bias is known says weighs more.
struct WheelConstraint {
  Matrix3d R_imu_vehicle = Matrix3d::Identity();
  double sigma_sideways = 0.3;  ///< m/s
  double sigma_up = 0.3;        ///< m/s
  double sigma_climb = 0.5;     ///< velocity along the world's vertical, m/s
  double sigma_tilt = 0.1;      ///< rad
  double speed_walk = 0.3;      ///< standard deviation of the speed's change in a second, m/s
};
FactorPtr wheel_factor(StateId id, const WheelConstraint& constraint);
/// The speed's change over `seconds` between two states.
FactorPtr steady_factor(StateId from, const WheelConstraint& constraint, double seconds);

}  // namespace partita::fusion

#endif  // PARTITA_HOST_TASKS_FUSION_FACTORS_H
