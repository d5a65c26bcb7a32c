#include "host/tasks/fusion/window.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "host/tasks/fusion/factors.h"

namespace partita::fusion {
namespace {

constexpr double kFirstDamping = 1e-6;
constexpr double kMostDamping = 1e6;
constexpr double kEnough = 1e-6;  ///< relative decrease of the cost that ends the iterations

/// Huber's loss of a residual, and the factor by which it and its derivatives are scaled so that
/// plain least squares takes the same step (iteratively reweighted).
struct Loss {
  double cost = 0;
  double scale = 1;
};
Loss loss(const Eigen::VectorXd& r, double huber) {
  const double length = r.norm();
  if (length <= huber) return {0.5 * length * length, 1};
  return {huber * (length - 0.5 * huber), std::sqrt(huber / length)};
}

/// Adds one factor's J^T J and J^T r; `offset` says where a state's columns begin.
template <class Offset>
void accumulate(const Factor& factor, const States& states, Offset offset, Eigen::MatrixXd& H,
                Eigen::VectorXd& g, double& cost) {
  std::vector<StateJacobian> J;
  Eigen::VectorXd r = factor.residual(states, &J);
  const Loss l = loss(r, factor.huber());
  cost += l.cost;
  r *= l.scale;
  for (StateJacobian& block : J) block *= l.scale;
  const std::vector<StateId>& ids = factor.states();
  for (std::size_t a = 0; a < ids.size(); ++a) {
    const Eigen::Index row = offset(ids[a]);
    g.segment<kStateSize>(row) += J[a].transpose() * r;
    for (std::size_t b = 0; b < ids.size(); ++b) {
      H.block<kStateSize, kStateSize>(row, offset(ids[b])) += J[a].transpose() * J[b];
    }
  }
}

}  // namespace

StateId Window::push(const NavState& state) {
  if (states_.values.size() == most_) marginalise_oldest();
  states_.values.push_back(state);
  return states_.last();
}

Window::System Window::linearise() const {
  const auto size = static_cast<Eigen::Index>(states_.values.size()) * kStateSize;
  System system{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 0};
  const auto offset = [this](StateId id) {
    return static_cast<Eigen::Index>(id - states_.first) * kStateSize;
  };
  for (const FactorPtr& factor : factors_) {
    accumulate(*factor, states_, offset, system.H, system.g, system.cost);
  }
  return system;
}

double Window::cost(const States& states) const {
  double sum = 0;
  for (const FactorPtr& factor : factors_) {
    sum += loss(factor->residual(states, nullptr), factor->huber()).cost;
  }
  return sum;
}

SolveResult Window::solve(int most_iterations) {
  SolveResult result;
  double damping = kFirstDamping;
  System system = linearise();
  result.initial_cost = result.final_cost = system.cost;
  while (result.iterations < most_iterations && damping <= kMostDamping) {
    ++result.iterations;
    Eigen::MatrixXd H = system.H;
    H.diagonal() *= 1 + damping;
    const Eigen::LLT<Eigen::MatrixXd> llt(H);
    const Eigen::VectorXd step = llt.solve(-system.g);
    if (llt.info() != Eigen::Success || !step.allFinite()) {
      damping *= 100;
      result.solved = damping <= kMostDamping;
      continue;
    }
    States changed = states_;
    for (std::size_t i = 0; i < changed.values.size(); ++i) {
      changed.values[i] = changed.values[i].plus(
          step.segment<kStateSize>(static_cast<Eigen::Index>(i) * kStateSize));
    }
    const double now = cost(changed);
    if (!(now <= system.cost)) {
      damping *= 100;
      continue;
    }
    states_ = std::move(changed);
    const bool settled = system.cost - now <= kEnough * system.cost;
    result.final_cost = now;
    if (settled) break;
    damping = std::max(damping * 0.1, 1e-12);
    system = linearise();
  }
  return result;
}

StateMatrix Window::newest_covariance() const {
  const System system = linearise();
  const auto size = system.H.rows();
  if (size == 0) return StateMatrix::Zero();
  const Eigen::LLT<Eigen::MatrixXd> llt(system.H);
  if (llt.info() != Eigen::Success) return StateMatrix::Zero();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(size, kStateSize);
  columns.bottomRows<kStateSize>().setIdentity();
  return llt.solve(columns).bottomRows<kStateSize>();
}

void Window::marginalise_oldest() {
  const StateId oldest = states_.first;
  std::vector<FactorPtr> leaving, staying;
  std::map<StateId, Eigen::Index> offsets;
  for (const FactorPtr& factor : factors_) {
    const auto& ids = factor->states();
    const bool touched = std::find(ids.begin(), ids.end(), oldest) != ids.end();
    (touched ? leaving : staying).push_back(factor);
    if (!touched) continue;
    for (const StateId id : ids) offsets[id] = 0;
  }
  offsets[oldest] = 0;
  Eigen::Index size = 0;
  for (auto& [id, offset] : offsets) {
    offset = size;
    size += kStateSize;
  }
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
  double ignored = 0;
  for (const FactorPtr& factor : leaving) {
    accumulate(
        *factor, states_, [&](StateId id) { return offsets.at(id); }, H, g, ignored);
  }
  // Schur complement on what stays: H' = Hss - Hso Hoo^-1 Hos, and likewise the gradient.
  const Eigen::Index rest = size - kStateSize;
  factors_ = std::move(staying);
  if (rest > 0) {
    const Eigen::LDLT<Eigen::MatrixXd> oo(H.topLeftCorner(kStateSize, kStateSize));
    const Eigen::MatrixXd gain = oo.solve(H.topRightCorner(kStateSize, rest)).transpose();
    Eigen::MatrixXd S = H.bottomRightCorner(rest, rest) - gain * H.topRightCorner(kStateSize, rest);
    const Eigen::VectorXd s = g.tail(rest) - gain * g.head(kStateSize);
    S = 0.5 * (S + S.transpose()).eval();
    // As residuals: S = J^T J with J = sqrt(D) V^T, and J^T r = s. Directions of no information,
    // and those that rounding made negative, are left out.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(S);
    const Eigen::VectorXd values = eigen.eigenvalues();
    const double least = 1e-12 * std::max(values.maxCoeff(), 0.0);
    Eigen::VectorXd root = Eigen::VectorXd::Zero(rest), inverse = root;
    for (Eigen::Index i = 0; i < rest; ++i) {
      if (!(values[i] > least)) continue;
      root[i] = std::sqrt(values[i]);
      inverse[i] = 1 / root[i];
    }
    std::vector<StateId> ids;
    std::vector<NavState> at;
    for (const auto& [id, offset] : offsets) {
      if (id == oldest) continue;
      ids.push_back(id);
      at.push_back(states_.at(id));
    }
    const Eigen::MatrixXd V = eigen.eigenvectors().transpose();
    factors_.push_back(linear_factor(std::move(ids), std::move(at), inverse.asDiagonal() * (V * s),
                                     root.asDiagonal() * V));
  }
  states_.values.pop_front();
  ++states_.first;
}

void Window::move_world(const sensing::Pose& T_new_old) {
  for (NavState& s : states_.values) {
    s.R_world_imu = so3::normalised(T_new_old.linear() * s.R_world_imu);
    s.position = T_new_old * s.position;
    s.velocity = T_new_old.linear() * s.velocity;
  }
  for (FactorPtr& factor : factors_) factor = moved_factor(factor, T_new_old);
}

void Window::restart(const NavState& state, const StateVector& sigma) {
  const StateId id = states_.values.empty() ? states_.first : states_.last() + 1;
  states_.first = id;
  states_.values.assign(1, state);
  factors_.assign(1, prior_factor(id, state, sigma));
}

}  // namespace partita::fusion
