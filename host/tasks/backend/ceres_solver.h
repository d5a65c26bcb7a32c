// The same problem given to Ceres: the oracle of the tests and the peer of the benchmarks.
// Automatic derivatives and Schur elimination, as in Ceres's own bundle adjuster.
#ifndef PARTITA_HOST_TASKS_BACKEND_CERES_SOLVER_H
#define PARTITA_HOST_TASKS_BACKEND_CERES_SOLVER_H

#include "host/tasks/backend/solver.h"

namespace partita::backend {

/// DENSE_SCHUR; SPARSE_SCHUR from 5,000 unknowns of cameras on. Parts: JU is Ceres's evaluation of
/// Jacobians, CFS its whole linear solver (elimination included), CC its evaluation of residuals.
Summary solve_with_ceres(Problem& problem, const SolverOptions& options, int threads);

/// Ceres's cost of the problem as it is.
double ceres_cost(const Problem& problem, const SolverOptions& options);

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_CERES_SOLVER_H
