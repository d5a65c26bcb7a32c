// Inertial preintegration against integration in small steps, and every derivative written by hand
// against differences.
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "host/tasks/fusion/factors.h"

namespace partita::fusion {
namespace {

/// A motion whose rates and forces change all the time.
ImuSample reading(double t) {
  ImuSample s;
  s.timestamp_ns = std::llround(t * 1e9);
  s.gyro = {0.4 * std::sin(2 * t), 0.3 * std::cos(3 * t), 0.5 + 0.2 * std::sin(t)};
  s.accel = {1.5 * std::cos(t), 2.0 * std::sin(2 * t), 9.8 + std::sin(5 * t)};
  return s;
}

std::vector<ImuSample> readings(double seconds, double step) {
  std::vector<ImuSample> samples;
  for (int k = 0; k * step <= seconds + step / 2; ++k) samples.push_back(reading(k * step));
  return samples;
}

Preintegration preintegrated(const Bias& bias, double seconds = 1) {
  Preintegration p(bias, {});
  p.integrate(readings(seconds, 0.005), 0, std::llround(seconds * 1e9));
  return p;
}

TEST(FusionSo3, ExpAndLogAreInverse) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double length : {0.0, 1e-9, 1e-6, 1e-3, 0.5, 2.0, 3.1}) {
    const Vector3d axis = Vector3d(uniform(random), uniform(random), uniform(random)).normalized();
    EXPECT_LT((so3::log(so3::exp(axis * length)) - axis * length).norm(), 1e-9) << length;
    EXPECT_LT((so3::right_jacobian(axis * length) * so3::inverse_right_jacobian(axis * length) -
               Matrix3d::Identity())
                  .norm(),
              1e-8)
        << length;
  }
}

TEST(FusionPreintegration, IsWhatSmallStepsGive) {
  const Bias bias{{0.01, -0.02, 0.03}, {0.1, 0.2, -0.1}};
  const Preintegration measured = preintegrated(bias);
  // Brute force: Euler at 10 microseconds in the world, from a state of its own.
  NavState state;
  state.R_world_imu = so3::exp({0.2, -0.3, 0.7});
  state.position = {1, 2, 3};
  state.velocity = {4, -5, 0.5};
  state.bias = bias;
  const NavState expected = measured.predict(state);
  constexpr double h = 1e-5;
  for (int k = 0; k < 100000; ++k) {
    const ImuSample s = reading((k + 0.5) * h);
    const Vector3d a = state.R_world_imu * (s.accel - bias.accel) + gravity();
    state.position += state.velocity * h + a * (h * h / 2);
    state.velocity += a * h;
    state.R_world_imu = state.R_world_imu * so3::exp((s.gyro - bias.gyro) * h);
  }
  EXPECT_LT(so3::log(expected.R_world_imu.transpose() * state.R_world_imu).norm(), 5e-5);
  EXPECT_LT((expected.velocity - state.velocity).norm(), 5e-4);
  EXPECT_LT((expected.position - state.position).norm(), 5e-4);
}

TEST(FusionPreintegration, BiasJacobiansAreDerivatives) {
  const Bias bias{{0.01, -0.02, 0.03}, {0.1, 0.2, -0.1}};
  const Preintegration base = preintegrated(bias);
  constexpr double d = 1e-5;
  for (int i = 0; i < 3; ++i) {
    Bias gyro = bias, accel = bias;
    gyro.gyro[i] += d;
    accel.accel[i] += d;
    const Preintegration by_gyro = preintegrated(gyro), by_accel = preintegrated(accel);
    EXPECT_LT((so3::log(base.R.transpose() * by_gyro.R) / d - base.dR_dgyro.col(i)).norm(), 1e-4);
    EXPECT_LT(((by_gyro.p - base.p) / d - base.dp_dgyro.col(i)).norm(), 1e-3);
    EXPECT_LT(((by_gyro.v - base.v) / d - base.dv_dgyro.col(i)).norm(), 1e-3);
    EXPECT_LT(((by_accel.p - base.p) / d - base.dp_daccel.col(i)).norm(), 1e-6);
    EXPECT_LT(((by_accel.v - base.v) / d - base.dv_daccel.col(i)).norm(), 1e-6);
  }
}

TEST(FusionPreintegration, AHoleIsBridgedAndTold) {
  std::vector<ImuSample> samples = readings(1, 0.005);
  samples.erase(samples.begin() + 80, samples.begin() + 120);
  Preintegration whole({}, {}), holed({}, {});
  whole.integrate(readings(1, 0.005), 0, 1'000'000'000);
  holed.integrate(samples, 0, 1'000'000'000);
  EXPECT_EQ(whole.bridged_seconds(), 0);
  EXPECT_NEAR(holed.bridged_seconds(), 0.205, 1e-6);
  EXPECT_GT(holed.covariance()(6, 6), 10 * whole.covariance()(6, 6));
  EXPECT_LT((holed.v - whole.v).norm(), 0.5);
}

/// The derivatives that a factor gives against differences of its residual.
void expect_derivatives(const Factor& factor, const States& states) {
  std::vector<StateJacobian> jacobians;
  const Eigen::VectorXd r = factor.residual(states, &jacobians);
  ASSERT_EQ(jacobians.size(), factor.states().size());
  constexpr double d = 1e-6;
  for (std::size_t s = 0; s < jacobians.size(); ++s) {
    for (int i = 0; i < kStateSize; ++i) {
      States forward = states, backward = states;
      StateVector step = StateVector::Zero();
      step[i] = d;
      NavState& f = forward.at(factor.states()[s]);
      NavState& b = backward.at(factor.states()[s]);
      f = f.plus(step);
      b = b.plus(-step);
      const Eigen::VectorXd by_difference =
          (factor.residual(forward, nullptr) - factor.residual(backward, nullptr)) / (2 * d);
      const double scale = std::max(1.0, by_difference.norm());
      EXPECT_LT((by_difference - jacobians[s].col(i)).norm() / scale, 2e-4)
          << "state " << s << " part " << i;
    }
  }
}

States two_states() {
  States states;
  states.first = 7;
  NavState a;
  a.R_world_imu = so3::exp({0.2, -0.3, 0.7});
  a.position = {1, 2, 3};
  a.velocity = {4, -5, 0.5};
  a.bias = {{0.012, -0.018, 0.031}, {0.12, 0.17, -0.08}};
  NavState b = preintegrated(a.bias).predict(a);
  StateVector off;
  off << 0.02, -0.01, 0.03, 0.1, -0.2, 0.1, 0.05, 0.1, -0.1, 1e-3, 2e-3, -1e-3, 0.01, 0.02, -0.01;
  states.values = {a, b.plus(off)};
  return states;
}

TEST(FusionFactors, DerivativesAreRight) {
  const States states = two_states();
  const Bias measured_at{{0.01, -0.02, 0.03}, {0.1, 0.2, -0.1}};
  expect_derivatives(*inertial_factor(7, preintegrated(measured_at)), states);
  expect_derivatives(*position_factor(8, {.position = {1, 1, 1}, .seconds = 0.04}), states);
  expect_derivatives(*ground_velocity_factor(7, {3, 4}, 0.3, 0.5), states);
  expect_derivatives(*standstill_factor(7, {0.01, 0, 0}, 0.02, 1e-3), states);
  WheelConstraint wheels;
  wheels.R_imu_vehicle = sensing::vehicle_in_camera_axes();
  expect_derivatives(*wheel_factor(8, wheels), states);
  expect_derivatives(*steady_factor(7, wheels, 0.1), states);
  VisualMotion motion;
  motion.T_from_to.linear() = so3::exp({0.3, 0.1, 0.4});
  motion.T_from_to.translation() = Vector3d(3, -3, 1);
  motion.information.diagonal() << 1, 2, 3, 4, 5, 6;
  Pose T_imu_cam = Pose::Identity();
  T_imu_cam.linear() = so3::exp({1.2, -0.4, 0.3});
  T_imu_cam.translation() = Vector3d(0.3, -0.2, 0.5);
  expect_derivatives(*visual_factor(7, 8, motion, T_imu_cam), states);
}

}  // namespace
}  // namespace partita::fusion
