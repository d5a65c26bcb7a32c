// Moments: what tasks that share engines are in the middle of, in times since then, and what
// follows from it. The same few commands side by side come back on thousands of placements and
// frames; each moment is simulated command by command the first time, and looked up from then on.
// Inside the partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_MOMENTS_H
#define PARTITA_PARTITION_SIMULATE_MOMENTS_H

#include <array>
#include <vector>

#include "partition/simulate/host_threads.h"
#include "partition/simulate/known.h"

namespace partita::partition {

/// A task in the middle of a program.
struct Running {
  std::uint32_t task = 0;  ///< index, which decides ties
  std::uint32_t op = 0;    ///< next one
  const CompiledTask* compiled = nullptr;
  const CompiledFrame* program = nullptr;
  Freedom free;
  Ns clock = 0, queue_end = 0;
  bool operator==(const Running&) const = default;
};

/// Time that engines were held: of a device's compute engines, or of a node's cores.
struct Held {
  Ns busy = 0;
  std::uint32_t of = 0;
  bool cores = false;
};
/// Mostly of one device and one node.
struct AllHeld {
  std::array<Held, 2> first;
  std::vector<Held> more;
  void add(const Held& held);
};

/// All times are since the moment.
struct Moment {
  /// What comes next if nobody joins: the first of the running tasks is through.
  struct Finish {
    Moment* after = nullptr;  ///< null: not known yet
    Ns time = 0, queue_end = 0;
    std::uint32_t task = 0;
    AllHeld held;
  };
  Ns taken_until = 0;  ///< all engines and memories are free from then on
  Finish finish;
  std::vector<Running> running;
  std::vector<Ns> taken;  ///< as timeline::Placement::save() gives it
};

class Moments {
 public:
  /// `compiler` and the tasks that it compiled must outlive it.
  explicit Moments(const Compiler& compiler);

  /// Nobody runs and everything is free.
  Moment* idle() const { return idle_; }
  /// What comes next if a task joins at a time by which nobody is through: its clock then.
  struct Start {
    const Moment* before = nullptr;
    Running joining;
    Moment* after = nullptr;
    AllHeld held;  ///< from the moment until then
  };
  const Start& start(const Moment& moment, const Running& joining) {
    const std::uint64_t hash =
        mixed(mixed(mixed(mixed(joining.task, &moment), joining.clock), joining.queue_end),
              joining.program);
    const Start* known = starts_.find(hash, [&](const Start& start) {
      return start.before == &moment && start.joining == joining;
    });
    return known != nullptr ? *known : find_start(hash, moment, joining);
  }
  const Moment::Finish& finish(Moment& moment) {
    return moment.finish.after != nullptr ? moment.finish : find_finish(moment);
  }
  /// How many moments had to be simulated so far.
  std::size_t simulated() const { return simulated_; }
  /// False once a moment was too long for its calendars to forget nothing; it may be wrong.
  bool exact() const { return exact_; }
  /// Forgets everything if that is much, or not exact: Moments in use are gone.
  void bound_memory();

 private:
  const Moment::Finish& find_finish(Moment& moment);
  const Start& find_start(std::uint64_t hash, const Moment& moment, const Running& joining);
  void load(const Moment& moment);
  std::size_t advance(Ns before, std::uint32_t before_task);
  Moment* known(Ns at);
  AllHeld held() const;

  HostThreads threads_;
  std::vector<Running> running_;  ///< while a moment is simulated
  Known<Moment> moments_;
  Known<Start> starts_;
  Moment* idle_ = nullptr;
  std::size_t bytes_ = 0;  ///< of all moments and starts
  std::size_t simulated_ = 0;
  bool exact_ = true;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_MOMENTS_H
