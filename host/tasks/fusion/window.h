// A sliding window of states and the factors between them, solved by Levenberg-Marquardt with dense
// normal equations (Eigen's Cholesky: a window is a few hundred unknowns). The oldest state leaves
// by marginalisation: what its factors say about the others stays, as a quadratic form at the
// values of that moment (Schur complement). Fixing it instead would claim that it is known exactly,
// and would forget how biases and attitude depend on each other, which is what bridges a gap.
#ifndef PARTITA_HOST_TASKS_FUSION_WINDOW_H
#define PARTITA_HOST_TASKS_FUSION_WINDOW_H

#include <cstddef>
#include <vector>

#include "host/tasks/fusion/factor.h"
#include "host/tasks/sensing/frame.h"

namespace partita::fusion {

struct SolveResult {
  int iterations = 0;
  double initial_cost = 0;  ///< half the sum of squares, losses applied
  double final_cost = 0;
  bool solved = true;  ///< false: no step could be computed (a singular or non-finite system)
};

/// Copying it is cheap: factors are shared and never change.
class Window {
 public:
  explicit Window(std::size_t most_states) : most_(most_states) {}

  /// Adds a state; the oldest is marginalised first where the window is full. Returns its id.
  StateId push(const NavState& state);
  /// Every state of the factor must still be in the window.
  void add(FactorPtr factor) { factors_.push_back(std::move(factor)); }
  SolveResult solve(int most_iterations);

  /// Covariance of the newest state's changes, at the current values. Zero if it is not known.
  StateMatrix newest_covariance() const;

  const States& states() const { return states_; }
  const NavState& newest() const { return states_.values.back(); }
  bool empty() const { return states_.values.empty(); }

  /// All states in a world that is turned about the vertical and shifted. Factors that speak of the
  /// world (fixes) must not be in the window yet.
  void move_world(const sensing::Pose& T_new_old);
  /// Forgets everything except the newest state, about which `prior` is all that is known.
  void restart(const NavState& state, const StateVector& sigma);

 private:
  struct System {
    Eigen::MatrixXd H;  ///< J^T J
    Eigen::VectorXd g;  ///< J^T r
    double cost = 0;
  };
  System linearise() const;
  double cost(const States& states) const;
  void marginalise_oldest();

  std::size_t most_;
  States states_;
  std::vector<FactorPtr> factors_;
};

}  // namespace partita::fusion

#endif  // PARTITA_HOST_TASKS_FUSION_WINDOW_H
