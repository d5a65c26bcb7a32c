// Summary: what a replayed record says of a run, in the terms of its frames: the latency of each
// branch and of perception as a whole, who used what for how long, and the energy. Everything here
// is predicted time on the declared hardware; nothing is measured.
#ifndef PARTITA_PARTITION_SUMMARY_H
#define PARTITA_PARTITION_SUMMARY_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "devices/timeline/schedule.h"

namespace partita::partition {

using timeline::Ns;

/// Of a set of times; p50 and p99 by nearest rank, so that they are times that occurred.
struct Distribution {
  double mean = 0;
  Ns p50 = 0, p99 = 0, max = 0;
};
Distribution distribution(std::vector<Ns> values);

/// When a frame's pictures are there, and its number.
struct Arrival {
  std::int64_t frame = 0;
  Ns time = 0;
};

struct BranchFrame {
  std::int64_t frame = 0;
  Ns arrival = 0;
  Ns finish = 0;  ///< END of the last thing that the branch did for the frame
  Ns latency() const { return finish - arrival; }
};

/// A task's share of a branch, mean per frame.
struct TaskTime {
  std::string branch, task;
  double as_it_ran_ns = 0;  ///< first START to last END
  double alone_ns = 0;      ///< the same with no other branch on the machine
};

struct BranchSummary {
  std::string name;  ///< of the host thread that drove it
  std::vector<BranchFrame> frames;
  Distribution latency;
  Distribution alone;  ///< latency with no other branch on the machine
  /// Frames it finished per second, from its first to its last; absent for fewer than two.
  std::optional<double> throughput_hz;
};

struct EngineUse {
  std::string name;
  Ns busy = 0;
  double share = 0;  ///< of the makespan, 0..1
};

struct Summary {
  std::vector<BranchSummary> branches;  ///< by rank of their threads
  std::vector<BranchFrame> perception;  ///< frames that all branches finished; the slower decides
  Distribution latency;                 ///< of perception
  std::size_t late = 0;       ///< frames of `perception` not finished when the next one arrived
  std::size_t processed = 0;  ///< frames that at least one branch finished; >= perception's
  std::optional<double> throughput_hz;  ///< the slower branch's; absent if a branch has none
  Ns makespan = 0;
  std::vector<TaskTime> tasks;
  std::vector<EngineUse> engines;
  timeline::Energy energy;        ///< over the makespan
  double energy_per_frame_j = 0;  ///< over `processed`
  double mean_power_w = 0;
};

/// `arrivals` in ascending order; the last frame's deadline is its arrival plus `period`. Throws
/// profile::Error if the record cannot be replayed.
Summary summarise(const timeline::Record& record, const timeline::Schedule& schedule,
                  const profile::Machine& machine, const std::vector<Arrival>& arrivals, Ns period);

/// The record with only one of its threads left: how it runs alone.
timeline::Record only_thread(const timeline::Record& record, std::uint32_t thread);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SUMMARY_H
