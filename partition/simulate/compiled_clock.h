// CompiledClock: the timeline's rules for host threads and messages, command by command, without
// its records. Inside the partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_COMPILED_CLOCK_H
#define PARTITA_PARTITION_SIMULATE_COMPILED_CLOCK_H

#include "partition/simulate/figures.h"
#include "partition/simulate/host_threads.h"
#include "partition/simulate/messages.h"

namespace partita::partition {

class CompiledClock {
 public:
  static constexpr bool kLooksAhead = false;
  static constexpr bool moved_others() { return false; }

  /// `compiler` must outlive it. One clock serves many placements, one after the other.
  explicit CompiledClock(const Compiler& compiler)
      : compiler_(compiler), threads_(compiler), messages_(compiler) {}

  /// Everything is free again, for the scene's tasks at their places.
  void reset(const Scene& scene);

  Ns now(std::uint32_t i) const { return threads_[i].clock; }
  Ns wakeup_ns(std::uint32_t i) const { return node_wakeup_[i]; }
  void wait_until(std::uint32_t i, Ns time) {
    threads_[i].clock = std::max(threads_[i].clock, time);
  }
  void sensor(std::uint32_t i, std::size_t frame) { wait_for(i, messages_.sensor(i, frame)); }
  void message(std::uint32_t i, std::uint32_t input, std::size_t frame) {
    wait_for(i, messages_.message(i, input, frame));
  }
  void load(std::uint32_t i) { threads_.load(i); }
  std::size_t steps(std::uint32_t i, std::size_t, const CompiledFrame& program, std::size_t first,
                    Ns until) {
    return threads_.steps(i, program, first, until);
  }
  Ns post(std::uint32_t i, std::size_t frame);

  /// The latest END or host clock.
  Ns horizon() const;
  const HostThreads& threads() const { return threads_; }
  const Messages& messages() const { return messages_; }
  /// What the frames that this clock has just driven have consumed.
  Consumption consumption() const;

 private:
  /// Who waits for a message pays for waking up.
  void wait_for(std::uint32_t i, Ns end) {
    if (end > threads_[i].clock) threads_[i].clock = end + node_wakeup_[i];
  }

  const Compiler& compiler_;
  HostThreads threads_;
  Messages messages_;
  const Scene* scene_ = nullptr;
  std::vector<Ns> node_wakeup_;                           ///< by task
  std::vector<std::uint64_t> device_bytes_, node_bytes_;  ///< of what was posted
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_COMPILED_CLOCK_H
