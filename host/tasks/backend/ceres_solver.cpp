#include "host/tasks/backend/ceres_solver.h"

#include <chrono>
#include <memory>

#include <ceres/ceres.h>

#include "host/tasks/backend/layout.h"
#include "host/tasks/backend/projection_functors.h"

namespace partita::backend {
namespace {

ceres::CostFunction* cost_function(const Problem& problem, const Observation& o) {
  if (problem.model == CameraModel::bal) {
    return new ceres::AutoDiffCostFunction<BalResidual, 2, 9, 3>(
        new BalResidual{o.measured[0], o.measured[1], o.weight});
  }
  return new ceres::AutoDiffCostFunction<StereoResidual, 3, 6, 3>(
      new StereoResidual{problem.rig, o.measured, o.weight});
}

ceres::LossFunction* loss_function(const SolverOptions& options) {
  if (options.loss == Loss::huber) return new ceres::HuberLoss(options.loss_scale);
  if (options.loss == Loss::cauchy) return new ceres::CauchyLoss(options.loss_scale);
  return nullptr;
}

void build(Problem& problem, const SolverOptions& options, ceres::Problem& out) {
  std::vector<bool> used(problem.cameras.size(), false);
  for (const Observation& o : problem.observations) {
    const auto camera = static_cast<std::size_t>(o.camera);
    used[camera] = true;
    out.AddResidualBlock(cost_function(problem, o), loss_function(options),
                         problem.cameras[camera].data(),
                         problem.points[static_cast<std::size_t>(o.point)].data());
  }
  for (std::size_t i = 0; i < problem.fixed.size(); ++i) {
    if (problem.fixed[i] && used[i]) out.SetParameterBlockConstant(problem.cameras[i].data());
  }
}

}  // namespace

Summary solve_with_ceres(Problem& problem, const SolverOptions& options, int threads) {
  const auto began = std::chrono::steady_clock::now();
  ceres::Problem ceres_problem;
  build(problem, options, ceres_problem);
  ceres::Solver::Options o;
  const int unknowns = static_cast<int>(problem.cameras.size()) * layout_of(problem.model).dof;
  o.linear_solver_type = unknowns < 5000 ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  o.num_threads = threads;
  o.max_num_iterations = options.max_iterations;
  o.function_tolerance = options.function_tolerance;
  o.gradient_tolerance = options.gradient_tolerance;
  o.parameter_tolerance = options.parameter_tolerance;
  o.initial_trust_region_radius = options.initial_radius;
  o.logging_type = ceres::SILENT;
  ceres::Solver::Summary s;
  ceres::Solve(o, &ceres_problem, &s);

  Summary summary;
  summary.initial_cost = s.initial_cost;
  summary.final_cost = s.final_cost;
  summary.converged = s.termination_type == ceres::CONVERGENCE;
  summary.termination = s.message;
  summary.linear_solver = ceres::LinearSolverTypeToString(s.linear_solver_type_used);
  for (const ceres::IterationSummary& it : s.iterations) {
    summary.iterations.push_back({.number = it.iteration,
                                  .cost = it.cost,
                                  .cost_change = it.cost_change,
                                  .gradient = it.gradient_max_norm,
                                  .step = it.step_norm,
                                  .gain = it.relative_decrease,
                                  .radius = it.trust_region_radius,
                                  .accepted = it.step_is_successful,
                                  .seconds = it.iteration_time_in_seconds});
  }
  const std::chrono::duration<double> total = std::chrono::steady_clock::now() - began;
  summary.total_seconds = total.count();
  summary.setup_seconds = total.count() - s.minimizer_time_in_seconds;
  summary.parts = {s.jacobian_evaluation_time_in_seconds, 0, s.linear_solver_time_in_seconds,
                   s.residual_evaluation_time_in_seconds, 0};
  return summary;
}

double ceres_cost(const Problem& problem, const SolverOptions& options) {
  Problem copy = problem;
  ceres::Problem ceres_problem;
  build(copy, options, ceres_problem);
  double cost = 0;
  ceres_problem.Evaluate({}, &cost, nullptr, nullptr, nullptr);
  return cost;
}

}  // namespace partita::backend
