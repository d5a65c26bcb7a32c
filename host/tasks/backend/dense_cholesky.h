// A dense Cholesky factorisation and solution in place: Eigen's, compiled once for the processor
// that the build is for and, on x86, once for AVX2 and FMA, which is twice as fast and chosen where
// the processor has them.
#ifndef PARTITA_HOST_TASKS_BACKEND_DENSE_CHOLESKY_H
#define PARTITA_HOST_TASKS_BACKEND_DENSE_CHOLESKY_H

namespace partita::backend {

/// S: n x n by columns, lower triangle, becomes its factor. x: right-hand side, becomes the
/// solution. False if S is not positive definite.
bool solve_dense(int n, double* S, double* x);

/// The variants, for tests. The wide one may be called only where has_wide_cholesky().
bool solve_dense_baseline(int n, double* S, double* x);
bool solve_dense_wide(int n, double* S, double* x);
bool has_wide_cholesky();

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_DENSE_CHOLESKY_H
