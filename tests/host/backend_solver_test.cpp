// The whole of bundle adjustment on a device, against Ceres.
#include <cmath>
#include <cstdlib>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/io/bal.h"
#include "host/runtime/error.h"
#include "host/tasks/backend/cases.h"
#include "host/tasks/backend/ceres_solver.h"
#include "host/tasks/backend/solver.h"
#include "tests/kernels/kernel_tests.h"

namespace partita::backend {
namespace {

using runtime::Variant;

Summary solve_on(Variant variant, Problem& problem, const SolverOptions& options) {
  runtime::SessionOptions session_options;
  session_options.variant = variant;
  const runtime::Session session(tests::source_device(),
                                 kernels(problem.model, precision_of(variant)).list(),
                                 session_options);
  const Summary summary = BundleAdjuster(session, problem.model).solve(problem, options);
  session.save_binaries();
  return summary;
}

/// A stereo problem needs a fixed pose; BAL's is left free as it is in its files.
Problem problem_of(CameraModel model, std::uint32_t seed) {
  Problem problem = random_problem(model, 12, 400, 4, seed);
  if (model == CameraModel::stereo) {
    problem.fixed.assign(12, false);
    problem.fixed[0] = true;
  }
  return problem;
}

TEST(BundleAdjustment, EndsWhereCeresEnds) {
  for (const CameraModel model : {CameraModel::bal, CameraModel::stereo}) {
    for (const Loss loss : {Loss::none, Loss::huber, Loss::cauchy}) {
      SolverOptions options;
      options.loss = loss;
      options.loss_scale = 0.4;
      const Problem start = problem_of(model, 11);
      Problem ours = start, theirs = start;
      const Summary a = solve_on(Variant::cpu, ours, options);
      const Summary b = solve_with_ceres(theirs, options, 2);
      EXPECT_NEAR(a.initial_cost, b.initial_cost, 1e-9 * b.initial_cost);
      EXPECT_LT(a.final_cost, b.final_cost * (1 + 1e-5)) << to_string(model) << to_string(loss);
      EXPECT_TRUE(a.converged) << a.termination;
      EXPECT_NEAR(ceres_cost(ours, options), a.final_cost, 1e-9 * a.final_cost);
      EXPECT_LE(a.steps(), b.steps() + 2);
    }
  }
}

TEST(BundleAdjustment, CpuAndGpuVariantTakeTheSamePath) {
  const Problem start = problem_of(CameraModel::bal, 12);
  Problem cpu = start, gpu = start;
  const Summary a = solve_on(Variant::cpu, cpu, {});
  const Summary b = solve_on(Variant::gpu, gpu, {});
  ASSERT_EQ(a.steps(), b.steps());
  EXPECT_EQ(a.final_cost, b.final_cost);
  EXPECT_EQ(cpu.cameras, gpu.cameras);
  EXPECT_EQ(cpu.points, gpu.points);
}

TEST(BundleAdjustment, SinglePrecisionComesClose) {
  for (const CameraModel model : {CameraModel::bal, CameraModel::stereo}) {
    const Problem start = problem_of(model, 13);
    Problem full = start, single = start;
    const double expected = solve_on(Variant::cpu, full, {}).final_cost;
    const Summary summary = solve_on(Variant::fpga, single, {});
    EXPECT_LT(summary.final_cost, expected * 1.001) << to_string(model);
    EXPECT_LT(ceres_cost(single, {}), expected * 1.001) << to_string(model);
  }
}

TEST(BundleAdjustment, FixedPosesStay) {
  const Problem start = problem_of(CameraModel::stereo, 14);
  Problem problem = start;
  problem.fixed[5] = true;
  const Summary summary = solve_on(Variant::cpu, problem, {});
  EXPECT_LT(summary.final_cost, 0.5 * summary.initial_cost);
  EXPECT_EQ(problem.cameras[0], start.cameras[0]);
  EXPECT_EQ(problem.cameras[5], start.cameras[5]);
  EXPECT_NE(problem.cameras[6], start.cameras[6]);
}

TEST(BundleAdjustment, SaysWhyItEnds) {
  Problem problem = problem_of(CameraModel::stereo, 15);
  SolverOptions options;
  options.max_iterations = 1;
  const Summary summary = solve_on(Variant::cpu, problem, options);
  EXPECT_EQ(summary.steps(), 1);
  EXPECT_FALSE(summary.converged);
  EXPECT_THAT(summary.termination, ::testing::HasSubstr("the most iterations"));
  EXPECT_LT(summary.final_cost, summary.initial_cost);
}

TEST(BundleAdjustment, RefusesAStartWithoutAFiniteCost) {
  Problem problem = problem_of(CameraModel::bal, 16);
  problem.points[0] = {std::numeric_limits<double>::infinity(), 0, 0};
  problem.observations.push_back({.camera = 0, .point = 0});
  EXPECT_THROW(solve_on(Variant::cpu, problem, {}), Error);
  problem.observations.clear();
  EXPECT_THROW(solve_on(Variant::cpu, problem, {}), Error);
}

/// Two cameras at one place see one point once each: nearly everything is free.
TEST(BundleAdjustment, SurvivesASingularProblem) {
  Problem problem = random_problem(CameraModel::bal, 2, 1, 1, 17);
  problem.cameras[1] = problem.cameras[0];
  problem.observations = {{.camera = 0, .point = 0, .measured = {10, 10, 0}},
                          {.camera = 1, .point = 0, .measured = {-10, 10, 0}}};
  const Summary summary = solve_on(Variant::cpu, problem, {});
  EXPECT_LE(summary.final_cost, summary.initial_cost);
  for (const double value : problem.points[0]) EXPECT_TRUE(std::isfinite(value));
}

Problem read_problem(const std::string& path) {
  const io::BalProblem bal = io::read_bal(path);
  Problem problem;
  problem.cameras = bal.cameras;
  problem.points = bal.points;
  for (const io::BalObservation& o : bal.observations) {
    problem.observations.push_back(
        {.camera = o.camera, .point = o.point, .measured = {o.x, o.y, 0}});
  }
  return problem;
}

TEST(BundleAdjustmentData, BalInTheLargeAsGoodAsCeres) {
  const char* data = std::getenv("PARTITA_DATA");
  if (data == nullptr) GTEST_SKIP() << "PARTITA_DATA is not set";
  for (const char* name : {"problem-49-7776-pre.txt", "problem-21-11315-pre.txt"}) {
    const Problem start = read_problem(std::string(data) + "/bal/" + name);
    Problem ours = start, single = start, theirs = start;
    const Summary a = solve_on(Variant::cpu, ours, {});
    const Summary f = solve_on(Variant::fpga, single, {});
    const Summary b = solve_with_ceres(theirs, {}, 2);
    EXPECT_LT(a.final_cost, b.final_cost * (1 + 1e-4)) << name;
    EXPECT_LT(f.final_cost, b.final_cost * (1 + 1e-3)) << name;
    EXPECT_LT(ceres_cost(single, {}), b.final_cost * (1 + 1e-3)) << name;
  }
}

}  // namespace
}  // namespace partita::backend
