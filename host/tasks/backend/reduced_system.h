// CFS: the reduced camera system S dx = v, assembled from the device's blocks and factorised on the
// host: densely (Eigen) where S is small or full, sparsely (CHOLMOD) where it is large.
#ifndef PARTITA_HOST_TASKS_BACKEND_REDUCED_SYSTEM_H
#define PARTITA_HOST_TASKS_BACKEND_REDUCED_SYSTEM_H

#include <memory>
#include <span>
#include <vector>

#include "host/tasks/backend/structure.h"

namespace partita::backend {

class ReducedSystem {
 public:
  virtual ~ReducedSystem() = default;
  /// Solves with the blocks of `pairs` (dof x dof each, row by row, upper triangle of blocks) and
  /// what is added to the diagonal. False if S is not positive definite or the step not finite.
  virtual bool solve(std::span<const double> blocks, std::span<const double> diagonal,
                     std::span<const double> rhs, std::span<double> step) = 0;
  virtual const char* name() const = 0;
  virtual double multiply_adds() const = 0;  ///< of one factorisation
};

/// Sparse from 1,500 unknowns on, unless more than a third of the blocks is there.
std::unique_ptr<ReducedSystem> make_reduced_system(const Structure& structure, int dof);

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_REDUCED_SYSTEM_H
