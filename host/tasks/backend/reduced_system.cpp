#include "host/tasks/backend/reduced_system.h"

#include <algorithm>
#include <cholmod.h>
#include <cmath>

#include <Eigen/Core>

#include "host/runtime/error.h"
#include "host/tasks/backend/dense_cholesky.h"

namespace partita::backend {
namespace {

bool finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

class DenseSystem : public ReducedSystem {
 public:
  DenseSystem(const Structure& structure, int dof)
      : structure_(structure), dof_(dof), S_(structure.cameras * dof, structure.cameras * dof) {}

  bool solve(std::span<const double> blocks, std::span<const double> diagonal,
             std::span<const double> rhs, std::span<double> step) override {
    S_.setZero();
    using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    for (std::size_t p = 0; p < structure_.pairs.size(); ++p) {
      const auto& pair = structure_.pairs[p];
      const Eigen::Map<const Block> block(blocks.data() + p * static_cast<std::size_t>(dof_ * dof_),
                                          dof_, dof_);
      S_.block(pair[3] * dof_, pair[2] * dof_, dof_, dof_) = block.transpose();
    }
    const Eigen::Index n = S_.rows();
    S_.diagonal() += Eigen::Map<const Eigen::VectorXd>(diagonal.data(), n);
    std::copy(rhs.begin(), rhs.end(), step.begin());
    if (!solve_dense(static_cast<int>(n), S_.data(), step.data())) return false;
    return finite(step);
  }
  const char* name() const override { return "dense Cholesky"; }
  double multiply_adds() const override {
    const auto n = static_cast<double>(S_.rows());
    return n * n * n / 6 + n * n;
  }

 private:
  const Structure& structure_;
  int dof_;
  Eigen::MatrixXd S_;
};

/// S as CHOLMOD takes it: its lower triangle by columns. The pattern is analysed once.
class SparseSystem : public ReducedSystem {
 public:
  SparseSystem(const Structure& structure, int dof) : structure_(structure), dof_(dof) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.supernodal = CHOLMOD_AUTO;
    common_.final_ll = 1;  // L D L' would go on with a negative pivot
    make_pattern();
    factor_ = cholmod_analyze(S_, &common_);
    if (factor_ == nullptr) {
      release();
      throw Error("bundle adjustment: the reduced system is too large for the memory");
    }
  }
  ~SparseSystem() override { release(); }
  SparseSystem(const SparseSystem&) = delete;
  SparseSystem& operator=(const SparseSystem&) = delete;

  bool solve(std::span<const double> blocks, std::span<const double> diagonal,
             std::span<const double> rhs, std::span<double> step) override {
    fill(blocks, diagonal);
    common_.quick_return_if_not_posdef = 1;
    if (!cholmod_factorize(S_, factor_, &common_) || common_.status != CHOLMOD_OK) return false;
    std::vector<double> right(rhs.begin(), rhs.end());
    cholmod_dense b{};
    b.nrow = b.nzmax = b.d = right.size();
    b.ncol = 1;
    b.x = right.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor_, &b, &common_);
    if (x == nullptr) return false;
    std::copy_n(static_cast<const double*>(x->x), step.size(), step.begin());
    cholmod_free_dense(&x, &common_);
    return finite(step);
  }
  const char* name() const override { return "sparse Cholesky (CHOLMOD)"; }
  double multiply_adds() const override { return common_.fl / 2 + common_.lnz * 2; }

 private:
  /// Column c of camera i: the rows of (i, i) from c on, then those of every later camera.
  void make_pattern() {
    const auto n = static_cast<std::size_t>(structure_.cameras * dof_);
    const auto dof = static_cast<std::size_t>(dof_);
    S_ = cholmod_allocate_sparse(n, n, structure_.pairs.size() * dof * dof, 1, 1, -1, CHOLMOD_REAL,
                                 &common_);
    if (S_ == nullptr) throw Error("bundle adjustment: the reduced system needs too much memory");
    auto* columns = static_cast<int*>(S_->p);
    auto* rows = static_cast<int*>(S_->i);
    int at = 0;
    for (std::size_t p = 0; p < structure_.pairs.size();) {
      const int camera = structure_.pairs[p][2];
      std::size_t end = p;
      while (end < structure_.pairs.size() && structure_.pairs[end][2] == camera) ++end;
      for (int c = 0; c < dof_; ++c) {
        columns[camera * dof_ + c] = at;
        for (std::size_t q = p; q < end; ++q) {
          for (int r = q == p ? c : 0; r < dof_; ++r)
            rows[at++] = structure_.pairs[q][3] * dof_ + r;
        }
      }
      p = end;
    }
    columns[n] = at;
  }

  void fill(std::span<const double> blocks, std::span<const double> diagonal) {
    auto* values = static_cast<double*>(S_->x);
    const auto dof = static_cast<std::size_t>(dof_);
    for (std::size_t p = 0; p < structure_.pairs.size();) {
      const int camera = structure_.pairs[p][2];
      std::size_t end = p;
      while (end < structure_.pairs.size() && structure_.pairs[end][2] == camera) ++end;
      for (std::size_t c = 0; c < dof; ++c) {
        for (std::size_t q = p; q < end; ++q) {
          const double* block = blocks.data() + q * dof * dof;  // the rows' transposes
          for (std::size_t r = q == p ? c : 0; r < dof; ++r) {
            double value = block[c * dof + r];
            if (q == p && r == c) value += diagonal[static_cast<std::size_t>(camera) * dof + c];
            *values++ = value;
          }
        }
      }
      p = end;
    }
  }

  void release() {
    cholmod_free_factor(&factor_, &common_);
    cholmod_free_sparse(&S_, &common_);
    cholmod_finish(&common_);
  }

  const Structure& structure_;
  int dof_;
  cholmod_common common_{};
  cholmod_sparse* S_ = nullptr;
  cholmod_factor* factor_ = nullptr;
};

}  // namespace

std::unique_ptr<ReducedSystem> make_reduced_system(const Structure& structure, int dof) {
  const double cameras = structure.cameras;
  const double share = static_cast<double>(structure.pairs.size()) / (cameras * (cameras + 1) / 2);
  const bool dense = cameras * dof < 1500 || (share > 1.0 / 3 && cameras * dof < 12000);
  if (dense) return std::make_unique<DenseSystem>(structure, dof);
  return std::make_unique<SparseSystem>(structure, dof);
}

}  // namespace partita::backend
