#include "host/tasks/backend/dense_cholesky.h"

#include <Eigen/Cholesky>

namespace partita::backend {

bool solve_dense_baseline(int n, double* S, double* x) {
  Eigen::Map<Eigen::MatrixXd> matrix(S, n, n);
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);
  if (factor.info() != Eigen::Success) return false;
  Eigen::Map<Eigen::VectorXd> vector(x, n);
  factor.solveInPlace(vector);
  return true;
}

#ifdef PARTITA_WIDE_CHOLESKY
bool has_wide_cholesky() {
  static const bool has = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  return has;
}
#else
bool has_wide_cholesky() {
  return false;
}
bool solve_dense_wide(int n, double* S, double* x) {
  return solve_dense_baseline(n, S, x);
}
#endif

bool solve_dense(int n, double* S, double* x) {
  return has_wide_cholesky() ? solve_dense_wide(n, S, x) : solve_dense_baseline(n, S, x);
}

}  // namespace partita::backend
