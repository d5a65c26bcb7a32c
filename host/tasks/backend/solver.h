// Levenberg-Marquardt bundle adjustment, divided as the paper divides it: Jacobian update (JU),
// Schur elimination (SE) and cost (CC) on the device; Cholesky factorisation (CFS) and gain ratio
// (GRE) on the processor beside it. Scaling, damping, trust region and termination are Ceres's, so
// that the two take the same path.
#ifndef PARTITA_HOST_TASKS_BACKEND_SOLVER_H
#define PARTITA_HOST_TASKS_BACKEND_SOLVER_H

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/runtime/session.h"
#include "host/tasks/backend/kernels.h"
#include "host/tasks/backend/problem.h"

namespace partita::backend {

struct SolverOptions {
  int max_iterations = 50;
  double function_tolerance = 1e-6;  ///< |change of cost| / cost
  double gradient_tolerance = 1e-10;
  double parameter_tolerance = 1e-8;
  double initial_radius = 1e4;
  Loss loss = Loss::none;
  double loss_scale = 1;
};

/// The paper's five parts of an iteration.
enum class Part { ju, se, cfs, cc, gre };
inline constexpr std::array kParts{Part::ju, Part::se, Part::cfs, Part::cc, Part::gre};
const char* to_string(Part part);
using PartSeconds = std::array<double, kParts.size()>;

struct Iteration {
  int number = 0;
  double cost = 0;  ///< half the sum of the squared, robustified residuals, after the iteration
  double cost_change = 0;
  double gradient = 0;  ///< largest component where the step began
  double step = 0;      ///< its length
  double gain = 0;      ///< decrease over the model's
  double radius = 0;    ///< of the trust region, afterwards
  bool accepted = false;
  double seconds = 0;
};

struct Summary {
  double initial_cost = 0, final_cost = 0;
  std::vector<Iteration> iterations;  ///< the first is the start
  std::string termination;            ///< why it ended
  bool converged = false;
  std::string linear_solver;
  double total_seconds = 0;  ///< all but loading kernels: lists, buffers, transfers, iterations
  double setup_seconds = 0;  ///< of them, before the first iteration
  PartSeconds parts{};       ///< wall clock
  PartSeconds predicted{};   ///< on an emulated machine: the predicted clock
  int steps() const { return static_cast<int>(iterations.size()) - 1; }
};

/// Adjusts cameras and points of problems on one device. The kernels are loaded by the constructor.
class BundleAdjuster {
 public:
  /// Session must have been made with kernels(model, precision).list().
  BundleAdjuster(const runtime::Session& session, CameraModel model);

  /// `problem` holds the best state found. `progress`, if there is one, hears of every iteration.
  /// Throws Error if the start has no finite cost.
  Summary solve(Problem& problem, const SolverOptions& options,
                const std::function<void(const Iteration&)>& progress = {}) const;

  /// The robust cost of the problem as it is.
  double cost(const Problem& problem, const SolverOptions& options) const;

 private:
  const runtime::Session& session_;
  CameraModel model_;
  Precision precision_;
};

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_SOLVER_H
