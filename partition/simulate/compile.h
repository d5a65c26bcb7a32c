// Compiled tasks: a task's programs turned into operations on the engines of one place, with their
// durations. What a simulation repeats thousands of times is worked out once here. Inside the
// partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_COMPILE_H
#define PARTITA_PARTITION_SIMULATE_COMPILE_H

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "devices/timeline/placement.h"
#include "partition/simulate/simulator.h"

namespace partita::partition {

using timeline::kNone;

enum class OpType : std::uint8_t { kernel, write, read, copy, host, finish };

/// One step of a program at a place. 32 bytes: simulations stream through thousands of them.
struct Op {
  Ns alone = 0;              ///< duration on free engines and an idle memory
  std::uint32_t detail = 0;  ///< index into CompiledTask::details and ::prepared
  std::uint32_t slot = 0;    ///< engine, for accounting: index into Compiler::slots
  /// From here on, so many commands of the same engine follow each other at once: the host enqueues
  /// each before the one before it can be over. 0: none does.
  std::uint32_t burst = 0;
  std::uint32_t free_run = kNone;  ///< index into CompiledFrame::free_runs, at the first of its ops
  OpType type = OpType::kernel;
  bool blocking = false;
  bool own_engine = false;  ///< no other task can use it: an FPGA's circuit
};

/// Commands enqueued one after the other, none of which the host waits for. Where nobody disturbs
/// them, the host clock H and the queue's END E become, in max-plus algebra,
///   E' = max(H + after_host, E + after_queue),  H' = H + host
/// since each command does E' = max(H + api + submit, E) + duration.
struct FreeRun {
  std::uint32_t ops = 0;
  Ns after_host = 0, after_queue = 0, host = 0;
};

/// What placing an operation on a busy machine takes, besides its timeline::Prepared.
struct OpDetail {
  timeline::NameId name = 0;  ///< index into Compiler::names
  std::uint64_t bytes = 0;    ///< over the device's link
  std::uint32_t compute_units = 1;
  const Work* work = nullptr;
  model::Launch launch;
};

/// What a frame takes where every command finds free engines and an idle memory, from whenever it
/// starts. On a busy machine none is shorter, and nothing starts earlier.
struct FreeFrame {
  Ns duration = 0;
  Ns queue_end = 0;  ///< after the start, of the last command; 0: there is none
  Ns host = 0;       ///< core time of host steps
  Ns compute = 0;    ///< time of the device's compute and copy engines; of a CPU: core time
  Ns to_device = 0, from_device = 0;
};

struct CompiledFrame {
  std::vector<Op> ops;
  FreeFrame free;
  std::vector<FreeRun> free_runs;
  /// What its device operations hold when nobody disturbs them, by slot.
  std::vector<std::pair<std::uint32_t, Ns>> held;
  std::uint64_t device_bytes = 0;  ///< moved: link plus memory traffic, for the energy
  std::uint64_t node_bytes = 0;    ///< the same of host steps
};

/// A task at one place.
struct CompiledTask {
  std::uint32_t device = kNone;  ///< kNone: on a node's CPU, host steps only
  std::uint32_t node = 0;
  Ns api_ns = 0, submit_ns = 0, wakeup_ns = 0;
  std::vector<CompiledFrame> frames;  ///< frame k is frames[k % size]
  std::vector<OpDetail> details;
  std::vector<timeline::Prepared> prepared;
  /// Largest shares of a memory that it draws at once: by a command of its queue, and by a host
  /// step beside it. A device's memory is its node's where they share one.
  std::uint32_t device_share = 0, host_share = 0;

  const CompiledFrame& frame(std::size_t k) const {
    return frames[frames.size() == 1 ? 0 : k % frames.size()];
  }
};

/// An engine as far as accounting goes: whose power it draws. Cores of a node count together.
struct Slot {
  std::string name;
  timeline::EngineKind kind = timeline::EngineKind::compute;
  std::uint32_t node = 0;
  std::uint32_t device = kNone;
};

/// Compiles tasks for a machine whose parts may be faster or slower than declared.
class Compiler {
 public:
  Compiler(const profile::Machine& machine, const Speeds& speeds);

  /// Throws profile::Error if a kernel's Work needs what the device does not have.
  CompiledTask compile(const TaskWork& task, const Place& place);

  const timeline::Layout& layout() const { return layout_; }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<Slot>& slots() const { return slots_; }
  /// Memory that commands of a device draw from: a node's index, or nodes + device where an FPGA
  /// has its own; kNone: a discrete GPU's, which nobody shares.
  std::uint32_t memory_of(std::uint32_t device) const;
  /// Time to swap the bitstream of one reconfigurable region.
  Ns load_ns(std::uint32_t device) const {
    return machine_.devices[device].profile.fabric.partial_load_ns;
  }
  /// Index of the network link between two nodes.
  std::uint32_t link_between(std::uint32_t a, std::uint32_t b) const;

 private:
  double device_speed(std::uint32_t device) const;
  std::uint32_t name(const std::string& text);
  std::uint32_t slot(std::string name, timeline::EngineKind kind, std::uint32_t node,
                     std::uint32_t device);
  timeline::Prepared prepare(const TaskWork& task, const Step& step, const CompiledTask& at,
                             OpDetail& detail) const;
  Op op(const Step& step, const CompiledTask& at);
  void add_step(const TaskWork& task, const Step& step, CompiledTask& at, CompiledFrame& frame);
  void find_runs(const CompiledTask& at, CompiledFrame& frame) const;

  const profile::Machine& machine_;
  Speeds speeds_;
  timeline::Layout layout_;
  timeline::Placement placement_;  ///< only prepares
  std::vector<model::DeviceModel> device_models_, node_models_;
  std::vector<std::string> names_{""};
  std::vector<Slot> slots_;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_COMPILE_H
