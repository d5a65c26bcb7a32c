// CompiledClock: the timeline's rules for in-order queues and host threads, without its records,
// events and checks. Where no other task can use an engine, and all that draw from its memory
// together cannot exceed its bandwidth, a command's times follow from its queue alone, and no
// calendar is asked. Inside the partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_COMPILED_CLOCK_H
#define PARTITA_PARTITION_SIMULATE_COMPILED_CLOCK_H

#include <vector>

#include "partition/simulate/figures.h"

namespace partita::partition {

class CompiledClock {
 public:
  /// `compiler` must outlive it. One clock serves many placements, one after the other.
  explicit CompiledClock(const Compiler& compiler);

  /// Everything is free again, for the scene's tasks at their places.
  void reset(const Scene& scene);

  Ns now(std::uint32_t i) const { return threads_[i].clock; }
  Ns wakeup_ns(std::uint32_t i) const { return threads_[i].node_wakeup; }
  void wait_until(std::uint32_t i, Ns time) {
    threads_[i].clock = std::max(threads_[i].clock, time);
  }
  void sensor(std::uint32_t i, std::size_t frame);
  void message(std::uint32_t i, std::uint32_t input, std::size_t frame);
  void load(std::uint32_t i);
  std::size_t steps(std::uint32_t i, std::size_t frame, const CompiledFrame& program,
                    std::size_t first, Ns until);
  Ns post(std::uint32_t i, std::size_t frame);

  /// The latest END or host clock.
  Ns horizon() const;
  /// Time that engines were held: of those with a calendar, by the calendars' own numbering, and
  /// beside it, by the compiler's slots. An engine's time is the sum of both.
  const timeline::Placement& calendars() const { return placement_; }
  const std::vector<Ns>& held_by_slot() const { return held_; }
  /// What the frames of the trace, which this clock has just driven, have consumed.
  Consumption consumption(const Trace& trace) const;

 private:
  struct Thread {
    const CompiledTask* task = nullptr;
    Ns clock = 0;
    Ns queue_end = 0;  ///< latest END of its in-order queue
    Ns node_wakeup = 0;
    bool host_free = false;      ///< there is always a core and bandwidth for its host steps
    bool device_free = false;    ///< all engines of its device are its own, link and circuits too
    bool circuits_free = false;  ///< its circuits are its own
    bool link_free = false;      ///< the device's link is its own
    bool bursts = false;  ///< its device's memory makes nobody wait, or is the calendars' own
  };
  void block(Thread& t, Ns end) {
    t.clock += t.task->api_ns;
    if (end > t.clock) t.clock = end + t.task->wakeup_ns;
  }
  void find_free();
  void step(Thread& t, const Op& op);
  std::size_t burst(Thread& t, const CompiledFrame& program, std::size_t first, Ns until);
  /// Whether nobody can notice when it runs: no need to take turns.
  static bool undisturbed(const Thread& t, const Op& op) {
    switch (op.type) {
      case OpType::finish:
        return true;
      case OpType::host:
        return t.host_free;
      case OpType::kernel:
      case OpType::copy:
        return op.own_engine ? t.circuits_free : t.device_free;
      default:
        return t.link_free;
    }
  }
  timeline::Placed placed(const Thread& t, const Op& op, Ns ready);
  void deliver(std::uint32_t i, std::uint32_t channel, std::size_t frame, std::uint32_t home,
               Ns posted);

  const Compiler& compiler_;
  timeline::Placement placement_;
  const Scene* scene_ = nullptr;
  std::vector<Thread> threads_;
  std::vector<Ns> posts_;      ///< by task and frame
  std::vector<Ns> delivered_;  ///< by channel, node and frame; kNot: not sent yet
  std::vector<Ns> held_;       ///< by slot, what no calendar knows
  std::vector<std::uint64_t> link_bytes_;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_COMPILED_CLOCK_H
