// What a measurement says about the states of a window: a residual, divided by its standard
// deviation, and its derivatives.
#ifndef PARTITA_HOST_TASKS_FUSION_FACTOR_H
#define PARTITA_HOST_TASKS_FUSION_FACTOR_H

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <vector>

#include "host/tasks/fusion/state.h"

namespace partita::fusion {

using StateId = std::uint64_t;  ///< counts all states ever made
using StateJacobian = Eigen::Matrix<double, Eigen::Dynamic, kStateSize>;

/// The window's states; the first one's id is `first`.
struct States {
  StateId first = 0;
  std::deque<NavState> values;

  const NavState& at(StateId id) const { return values.at(static_cast<std::size_t>(id - first)); }
  NavState& at(StateId id) { return values.at(static_cast<std::size_t>(id - first)); }
  bool contains(StateId id) const { return id >= first && id - first < values.size(); }
  StateId last() const { return first + values.size() - 1; }
};

class Factor {
 public:
  Factor() = default;
  virtual ~Factor() = default;
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;

  /// The states that it is about.
  virtual const std::vector<StateId>& states() const = 0;
  /// The residual r(x), whitened, and its derivatives by each state's change, in states()' order;
  /// without them where `jacobians` is null.
  virtual Eigen::VectorXd residual(const States& states,
                                   std::vector<StateJacobian>* jacobians) const = 0;
  /// Huber's loss: residuals longer than this count linearly. Infinite: plain squares.
  virtual double huber() const { return std::numeric_limits<double>::infinity(); }
};

using FactorPtr = std::shared_ptr<const Factor>;

}  // namespace partita::fusion

#endif  // PARTITA_HOST_TASKS_FUSION_FACTOR_H
