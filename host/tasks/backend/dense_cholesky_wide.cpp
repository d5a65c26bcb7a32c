// Compiled for AVX2 and FMA. Eigen's templates get a namespace of their own here: under their usual
// names the linker could take these instances for the rest of the program, on any processor.
#define Eigen EigenForWideCholesky
#include <Eigen/Cholesky>

#include "host/tasks/backend/dense_cholesky.h"

namespace partita::backend {

bool solve_dense_wide(int n, double* S, double* x) {
  Eigen::Map<Eigen::MatrixXd> matrix(S, n, n);
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);
  if (factor.info() != Eigen::Success) return false;
  Eigen::Map<Eigen::VectorXd> vector(x, n);
  factor.solveInPlace(vector);
  return true;
}

}  // namespace partita::backend
