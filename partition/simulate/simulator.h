// Simulator: the pipeline on a machine, without executing anything: every task is a host thread on
// the node of its place, takes its frames in order, waits for its inputs, runs its program's steps,
// posts its outputs. Times follow devices/timeline's rules to the nanosecond: reference() runs the
// real Timeline and records it, run() is a compiled form of the same that is some twenty times
// faster, quick() looks up what it has simulated before, on whatever placement, and leaves out
// frames that repeat. Tests hold them equal.
//
// Arbitration: always the task with the smallest virtual time acts next, ties by its order in the
// pipeline; an engine serves commands in the order in which they are enqueued, as early as they
// fit.
#ifndef PARTITA_PARTITION_SIMULATE_SIMULATOR_H
#define PARTITA_PARTITION_SIMULATE_SIMULATOR_H

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "devices/profile/machine.h"
#include "devices/timeline/schedule.h"
#include "partition/graph/pipeline.h"
#include "partition/graph/workload.h"
#include "partition/summary.h"

namespace partita::partition {

/// Where a task may run: a device of the machine (in the variant of its type), or, for a task
/// without kernels, the CPU of a node.
struct Place {
  bool is_device = false;
  std::uint32_t index = 0;  ///< into Machine::devices or Machine::nodes
  std::string name;         ///< "gtx1060", "pc/i5-8500"
  bool operator==(const Place&) const = default;
};

/// Per task of the pipeline: index into Simulator::places(task).
using TaskPlacement = std::vector<std::uint32_t>;

/// What-if: factors on speed, 1 = as declared, 2 = twice as fast. Empty: all 1.
struct Speeds {
  std::vector<double> devices;  ///< launches, arithmetic and memory of a device
  std::vector<double> nodes;    ///< host steps
  std::vector<double> links;    ///< networks between nodes, bandwidth and latency
  std::vector<double> buses;    ///< per device: the link between it and its host
};

struct SimulatorOptions {
  std::size_t frames = 100;
  Speeds speeds;
  /// FPGAs on which tasks that do not fit together take turns, loading their bitstream each time.
  bool allow_swap = false;
};

struct TaskFigures {
  Distribution latency;   ///< frame's trigger to the task's end
  Distribution duration;  ///< the task's start on a frame to its end, waiting for engines included
  double alone_ns = 0;    ///< mean duration of the same frames with no other task on the machine
  std::size_t late = 0;   ///< frames beyond the deadline
  std::size_t dropped = 0;
};

/// What a placement costs. All predicted.
struct Figures {
  Distribution latency;      ///< trigger to the last output task's end, frames that all outputs did
  Distribution perception;   ///< the same for Pipeline::perception
  Distribution age;          ///< at an output's end: since the trigger of the oldest data it used
  double throughput_hz = 0;  ///< of frames that all outputs finished
  std::size_t late = 0;      ///< frames after the deadline of any output task
  std::size_t dropped = 0;   ///< frames that some output task did not do
  std::size_t dropped_by_tasks = 0;  ///< TaskFigures::dropped of all tasks
  double energy_per_frame_j = 0;
  double power_w = 0;  ///< mean
  double price_usd = 0;
  Ns makespan = 0;
  std::vector<TaskFigures> tasks;
  std::vector<EngineUse> engines;  ///< busy for any time, largest share first
};

struct Reference {
  timeline::Record record;
  timeline::Schedule schedule;  ///< replayed from the record
  Figures figures;
};

class Simulator {
 public:
  /// Compiles every task for every place. `machine`, `pipeline`, `workload` must outlive it. Throws
  /// profile::Error: a task that the workload lacks, that has no variant for any device, …
  Simulator(const profile::Machine& machine, const Pipeline& pipeline, const Workload& workload,
            SimulatorOptions options = {});
  ~Simulator();
  Simulator(Simulator&&) noexcept;

  const profile::Machine& machine() const;
  const Pipeline& pipeline() const;
  const Workload& workload() const;
  const SimulatorOptions& options() const;

  /// Possible places of a task, in the machine's order.
  const std::vector<Place>& places(std::uint32_t task) const;
  /// "frontend=zcu102,depth=gtx1060,…"
  std::string name(const TaskPlacement& placement) const;

  /// Empty, or why it cannot be: "does not fit zcu102: BRAM36 1,020 of 912 needed by frontend 640 +
  /// backend 380". With allow_swap only a task that does not fit alone is refused.
  std::string infeasible(const TaskPlacement& placement) const;
  /// Area of the tasks placed on the device.
  profile::Area area(const TaskPlacement& placement, std::uint32_t device) const;
  /// Price in USD of the devices used and of the CPUs of the nodes used.
  double price(const TaskPlacement& placement) const;

  /// The figures over options().frames frames, the workload's repeated. Thread-safe.
  Figures run(const TaskPlacement& placement) const;
  /// The same without ages, tasks and engines, and mostly without simulating anything: it remembers
  /// what tasks beside each other did, and the more placements it is asked for, the less is new.
  Figures quick(const TaskPlacement& placement) const;
  /// The same as run() on the real Timeline, with the record and the schedule.
  Reference reference(const TaskPlacement& placement) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_SIMULATOR_H
