// Evaluator: what the search asks of a machine, a pipeline and a workload. simulated.h answers with
// the Simulator; tests answer with formulas. Everything is const and may be called by many threads.
#ifndef PARTITA_PARTITION_SEARCH_EVALUATOR_H
#define PARTITA_PARTITION_SEARCH_EVALUATOR_H

#include <memory>
#include <string>
#include <vector>

#include "partition/simulate/simulator.h"

namespace partita::partition {

/// A figure of a task's activations: of each of them at least, and on average over the frames that
/// a simulation does.
struct AtLeast {
  double any = 0, mean = 0;
};

/// Work of an activation on an engine that others may need as well: a GPU's compute, a bus, the
/// cores of a CPU (then: core time divided by the number of cores).
struct Load {
  std::uint32_t engine = 0;  ///< index into Evaluator::engines()
  AtLeast busy_ns;
};

/// What an activation of a task takes at the very least, whatever else runs. Bounds are made of it,
/// so it must never be more than what an evaluation shows.
struct Least {
  AtLeast duration_ns;  ///< the task's start on a frame to its end
  AtLeast energy_j;     ///< above idle
  std::vector<Load> loads;
};

class Evaluator {
 public:
  virtual ~Evaluator() = default;

  virtual const profile::Machine& machine() const = 0;
  virtual const Pipeline& pipeline() const = 0;
  /// Frames that an evaluation simulates.
  virtual std::size_t frames() const = 0;

  /// Possible places of a task; at least one.
  virtual const std::vector<Place>& places(std::uint32_t task) const = 0;
  /// "frontend=zcu102,depth=gtx1060,…"
  virtual std::string name(const TaskPlacement& placement) const = 0;

  /// Empty, or why the placement cannot be.
  virtual std::string infeasible(const TaskPlacement& placement) const = 0;
  virtual profile::Area area(const TaskPlacement& placement, std::uint32_t device) const = 0;
  virtual double price(const TaskPlacement& placement) const = 0;

  /// All figures of a feasible placement.
  virtual Figures evaluate(const TaskPlacement& placement) const = 0;
  /// The same without those of tasks and engines.
  virtual Figures quick(const TaskPlacement& placement) const = 0;

  /// Names of what Load::engine counts.
  virtual const std::vector<std::string>& engines() const = 0;
  virtual const Least& least(std::uint32_t task, std::uint32_t place) const = 0;

  /// The same machine with other speeds (those replace this one's, they do not multiply).
  virtual std::unique_ptr<Evaluator> with(const Speeds& speeds) const = 0;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_EVALUATOR_H
