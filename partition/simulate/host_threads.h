// HostThreads: tasks' host threads, their in-order queues and the engines they use, by the
// timeline's rules without its records, events and checks. Where no other task can use an engine,
// and all that draw from its memory together cannot exceed its bandwidth, a command's times follow
// from its queue alone, and no calendar is asked. Inside the partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_HOST_THREADS_H
#define PARTITA_PARTITION_SIMULATE_HOST_THREADS_H

#include <span>
#include <vector>

#include "partition/simulate/driver.h"

namespace partita::partition {

/// Which of a task's engines and memories make nobody wait, on a placement.
struct Freedom {
  bool host = false;      ///< there is always a core and bandwidth for its host steps
  bool device = false;    ///< all engines of its device are its own, link and circuits too
  bool circuits = false;  ///< its circuits are its own
  bool link = false;      ///< the device's link is its own
  bool bursts = false;    ///< its device's memory makes nobody wait, or is the calendars' own
  bool operator==(const Freedom&) const = default;
};
/// By task. A task has at most one command of its queue and one host step at work at a time; a
/// memory that can serve the largest of all of them at once never makes anybody wait, and neither
/// do as many cores as there are threads.
std::vector<Freedom> freedom_of(const Scene& scene, const Compiler& compiler);

/// A task's host thread and its queue.
struct HostThread {
  const CompiledTask* task = nullptr;
  Freedom free;
  Ns clock = 0;
  Ns queue_end = 0;  ///< latest END of its in-order queue
};

class HostThreads {
 public:
  explicit HostThreads(const Compiler& compiler);

  /// Everything is free again but what was saved (see timeline::Placement), and the clocks of
  /// `count` threads are at 0.
  void reset(std::size_t count, std::span<const Ns> taken = {});
  HostThread& operator[](std::uint32_t i) { return threads_[i]; }
  const HostThread& operator[](std::uint32_t i) const { return threads_[i]; }

  /// Operation `first` of a program and, as long as the thread's clock is below `until` or nobody
  /// can notice, more; returns how many.
  std::size_t steps(std::uint32_t i, const CompiledFrame& program, std::size_t first, Ns until);
  /// The program is over: what no calendar knows is added to the time that engines were held.
  void finish(std::uint32_t i, const CompiledFrame& program);
  /// Its bitstream is loaded, by a command of its queue.
  void load(std::uint32_t i);

  timeline::Placement& calendars() { return placement_; }
  const timeline::Placement& calendars() const { return placement_; }
  /// Time that engines were held and no calendar knows of, by the compiler's slots. An engine's
  /// time is the sum of both.
  const std::vector<Ns>& held_by_slot() const { return held_; }
  /// Calls add(kind, node, device, busy) for all that was held, in parts.
  template <typename Add>
  void each_busy(const Add& add) const {
    const auto& slots = compiler_.slots();
    for (std::size_t s = 0; s < slots.size(); ++s) {
      if (held_[s] > 0) add(slots[s].kind, slots[s].node, slots[s].device, held_[s]);
    }
    const auto& engines = placement_.engines();
    for (std::size_t e = 0; e < engines.size(); ++e) {
      const Ns busy = placement_.worked()[e];
      if (busy > 0) add(engines[e].kind, engines[e].node, engines[e].device, busy);
    }
  }

 private:
  static void block(HostThread& t, Ns end) {
    t.clock += t.task->api_ns;
    if (end > t.clock) t.clock = end + t.task->wakeup_ns;
  }
  /// Whether nobody can notice when it runs: no need to take turns.
  static bool undisturbed(const HostThread& t, const Op& op) {
    switch (op.type) {
      case OpType::finish:
        return true;
      case OpType::host:
        return t.free.host;
      case OpType::kernel:
      case OpType::copy:
        return op.own_engine ? t.free.circuits : t.free.device;
      default:
        return t.free.link;
    }
  }
  void step(HostThread& t, const Op& op);
  std::size_t burst(HostThread& t, const CompiledFrame& program, std::size_t first, Ns until);
  timeline::Placed placed(const HostThread& t, const Op& op, Ns ready);

  const Compiler& compiler_;
  timeline::Placement placement_;
  std::vector<HostThread> threads_;
  std::vector<Ns> held_;  ///< by slot
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_HOST_THREADS_H
