// Bundle adjustment without a device: derivatives, lists, steps of cameras, the reduced system.
#include <cmath>
#include <random>
#include <set>

#include <ceres/jet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/runtime/error.h"
#include "host/tasks/backend/camera.h"
#include "host/tasks/backend/cases.h"
#include "host/tasks/backend/golden.h"
#include "host/tasks/backend/projection_functors.h"
#include "host/tasks/backend/reduced_system.h"
#include "host/tasks/backend/structure.h"

namespace partita::backend {
namespace {

std::array<double, 9> ones() {
  return {1, 1, 1, 1, 1, 1, 1, 1, 1};
}

/// Residuals and Jacobians of one observation by the golden reference, unit scales.
golden::Linearised<double> by_hand(const Problem& problem, const Observation& o) {
  const auto record = camera_record(problem, problem.cameras[0], ones());
  const std::vector<double> measured(o.measured.begin(), o.measured.end()), weights{o.weight},
      scales(3, 1.0);
  const std::vector<int> slot_points{0};
  golden::Inputs<double> in;
  in.stereo = problem.model == CameraModel::stereo;
  in.slots = 1;
  in.state = problem.points[0];
  in.point_scales = scales;
  in.measured = measured;
  in.weights = weights;
  in.slot_points = slot_points;
  return golden::linearise<double>(in, record, 0);
}

/// The same by automatic differentiation, over the nine or six parameters of the camera. A stereo
/// camera's rotation is differentiated at exp(step) R: at zero.
template <class Functor, int kResiduals, int kDof>
void expect_automatic(const Problem& problem, const Functor& functor, double tolerance = 1e-9) {
  using Jet = ceres::Jet<double, kDof + 3>;
  const bool stereo = problem.model == CameraModel::stereo;
  Jet camera[9], point[3], residual[kResiduals];
  for (int i = 0; i < 3; ++i) {
    point[i] = Jet(problem.points[0][static_cast<std::size_t>(i)], kDof + i);
  }
  for (int i = 0; i < kDof; ++i)
    camera[i] = Jet(problem.cameras[0][static_cast<std::size_t>(i)], i);
  Jet turned[3];
  if (stereo) {  // the point turned by R first; then the step's rotation at zero
    const Jet rotation[3] = {Jet(problem.cameras[0][0]), Jet(problem.cameras[0][1]),
                             Jet(problem.cameras[0][2])};
    ceres::AngleAxisRotatePoint(rotation, point, turned);
    for (int i = 0; i < 3; ++i) {
      camera[i] = Jet(0.0, i);
      point[i] = turned[i];
    }
  }
  functor(camera, point, residual);
  const auto hand = by_hand(problem, problem.observations[0]);
  for (int r = 0; r < kResiduals; ++r) {
    EXPECT_NEAR(hand.r[r], residual[r].a, 1e-9 * (1 + std::abs(residual[r].a)));
    for (int k = 0; k < kDof; ++k) {
      const double expected = residual[r].v[k];
      EXPECT_NEAR(hand.jc[r * kDof + k], expected, tolerance * (1 + std::abs(expected)))
          << r << " " << k;
    }
    for (int k = 0; k < 3; ++k) {
      const double expected = residual[r].v[kDof + k];
      EXPECT_NEAR(hand.jp[3 * r + k], expected, tolerance * (1 + std::abs(expected)))
          << r << " " << k;
    }
  }
}

TEST(BackendDerivatives, EqualAutomaticOnesForBal) {
  for (std::uint32_t seed = 1; seed < 50; ++seed) {
    Problem problem = random_problem(CameraModel::bal, 1, 1, 1, seed);
    problem.observations = {{.measured = {3, 4, 0}, .weight = 0.7}};
    // Rotations from none through tiny ones to more than half a turn.
    const double size = seed == 1   ? 0
                        : seed < 10 ? std::pow(10.0, -static_cast<double>(seed))
                                    : seed / 12.0;
    for (std::size_t i = 0; i < 3; ++i) problem.cameras[0][i] *= 5 * size;
    // Automatic derivatives divide by the angle: of a tiny one they lose half their digits.
    expect_automatic<BalResidual, 2, 9>(problem, {3, 4, 0.7}, seed < 10 ? 1e-7 : 1e-9);
  }
}

TEST(BackendDerivatives, EqualAutomaticOnesForStereo) {
  for (std::uint32_t seed = 1; seed < 50; ++seed) {
    Problem problem = random_problem(CameraModel::stereo, 1, 1, 1, seed);
    problem.observations = {{.measured = {600, 180, 570}, .weight = 1.3}};
    expect_automatic<StereoResidual, 3, 6>(problem, {problem.rig, {600, 180, 570}, 1.3});
  }
}

TEST(BackendCamera, AStereoStepTurnsFromTheLeft) {
  const Problem problem = random_problem(CameraModel::stereo, 1, 1, 1, 3);
  const Camera& camera = problem.cameras[0];
  const double turn[3] = {0.3, -0.2, 0.1};
  const Camera after = moved(CameraModel::stereo, camera, {turn[0], turn[1], turn[2], 1, 2, 3});
  const double point[3] = {1, 2, 3};
  double once[3], expected[3], got[3];
  ceres::AngleAxisRotatePoint(camera.data(), point, once);
  ceres::AngleAxisRotatePoint(turn, once, expected);
  ceres::AngleAxisRotatePoint(after.data(), point, got);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(got[i], expected[i], 1e-12);
  EXPECT_DOUBLE_EQ(after[4], camera[4] + 2);
}

TEST(BackendStructure, ListsEveryObservationAndEveryPairOnce) {
  Problem problem = random_problem(CameraModel::bal, 9, 200, 3, 5);
  problem.fixed.assign(9, false);
  problem.fixed[4] = true;
  const Structure s = make_structure(problem);
  std::set<int> seen;
  for (int slot = 0; slot < s.slots; ++slot) {
    const int index = s.slot_observation[static_cast<std::size_t>(slot)];
    if (index >= 0) {
      EXPECT_TRUE(seen.insert(index).second);
    }
  }
  EXPECT_EQ(seen.size(), problem.observations.size());
  std::size_t expected = 0;  // pairs of observations of one point, cameras ascending
  for (const Observation& a : problem.observations) {
    for (const Observation& b : problem.observations) {
      const bool fixed = a.camera == 4 || b.camera == 4;
      expected += !fixed && a.point == b.point && a.camera <= b.camera ? 1 : 0;
    }
  }
  EXPECT_EQ(s.entries.size(), expected);
  for (const auto& pair : s.pairs) {
    for (int e = pair[0]; e < pair[1]; ++e) {
      const auto [i, j] = s.entries[static_cast<std::size_t>(e)];
      EXPECT_EQ(s.slot_point[static_cast<std::size_t>(i)],
                s.slot_point[static_cast<std::size_t>(j)]);
      const auto camera = [&](int slot) {
        return problem
            .observations[static_cast<std::size_t>(
                s.slot_observation[static_cast<std::size_t>(slot)])]
            .camera;
      };
      EXPECT_EQ(camera(i), pair[2]);
      EXPECT_EQ(camera(j), pair[3]);
    }
  }
  for (const auto& chunk : s.chunks) {
    EXPECT_EQ(chunk[2] % kLanes, 0);
    EXPECT_LE(chunk[2], kChunk);
  }
}

TEST(BackendStructure, RefusesWhatIsNotThere) {
  Problem problem = random_problem(CameraModel::bal, 2, 3, 1, 1);
  problem.observations.push_back({.camera = 2, .point = 0});
  EXPECT_THROW(make_structure(problem), Error);
  problem.observations.back() = {.camera = 0, .point = -1};
  EXPECT_THROW(make_structure(problem), Error);
}

/// A chain of cameras: sparse when there are many of them.
TEST(BackendReducedSystem, SparseAndDenseSolveTheSame) {
  for (const int cameras : {20, 200}) {
    Problem problem = random_problem(CameraModel::bal, cameras, 0, 0, 1);
    for (int i = 0; i < cameras; ++i) {
      problem.points.push_back({0, 0, 0});
      problem.observations.push_back({.camera = i, .point = i});
      if (i + 1 < cameras) problem.observations.push_back({.camera = i + 1, .point = i});
    }
    const Structure s = make_structure(problem);
    const auto system = make_reduced_system(s, 9);
    EXPECT_THAT(system->name(), ::testing::HasSubstr(cameras == 20 ? "dense" : "sparse"));
    std::mt19937 random(2);
    const auto number = [&] { return static_cast<double>(random() % 1000) / 1000 - 0.5; };
    const auto n = static_cast<std::size_t>(cameras * 9);
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(cameras * 9, cameras * 9);
    std::vector<double> blocks, diagonal(n, 40.0), rhs(n), step(n);
    for (const auto& pair : s.pairs) {
      for (int i = 0; i < 81; ++i) {
        const int r = pair[2] * 9 + i / 9, c = pair[3] * 9 + i % 9;
        const double value = pair[2] == pair[3] && i % 9 < i / 9 ? S(c, r) : number();
        S(r, c) = S(c, r) = value;
        blocks.push_back(value);
      }
    }
    for (double& value : rhs) value = number();
    ASSERT_TRUE(system->solve(blocks, diagonal, rhs, step));
    S.diagonal().array() += 40.0;
    const Eigen::VectorXd error = S * Eigen::Map<Eigen::VectorXd>(step.data(), S.rows()) -
                                  Eigen::Map<Eigen::VectorXd>(rhs.data(), S.rows());
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-12);
    diagonal.assign(n, -100.0);
    EXPECT_FALSE(system->solve(blocks, diagonal, rhs, step));  // not positive definite
  }
}

}  // namespace
}  // namespace partita::backend
