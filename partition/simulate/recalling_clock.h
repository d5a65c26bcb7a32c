// RecallingClock: the same times as CompiledClock's, looked up instead of simulated wherever the
// tasks that share engines have been in the same situation before, on whatever placement and frame.
// Inside the partitioner only.
//
// Tasks that can disturb each other on an engine, a core or a memory are one group; groups know of
// each other by messages only. A group is at a Moment since some time; it goes to the next when one
// of its tasks begins a frame's program or is through with one. Until then it is not known when
// that is: the clock of a task at work is a bound, which the exact time replaces when its turn has
// come and nobody can join before.
#ifndef PARTITA_PARTITION_SIMULATE_RECALLING_CLOCK_H
#define PARTITA_PARTITION_SIMULATE_RECALLING_CLOCK_H

#include <utility>

#include "partition/simulate/figures.h"
#include "partition/simulate/messages.h"
#include "partition/simulate/moments.h"

namespace partita::partition {

class RecallingClock {
 public:
  static constexpr bool kLooksAhead = true;
  bool moved_others() { return std::exchange(moved_, false); }

  explicit RecallingClock(const Compiler& compiler)
      : compiler_(compiler), moments_(compiler), messages_(compiler) {}

  /// Everything is free again, for the scene's tasks at their places, none of whose devices swaps
  /// bitstreams.
  void reset(const Scene& scene);

  Ns now(std::uint32_t i) const { return threads_[i].clock; }
  Ns wakeup_ns(std::uint32_t i) const { return threads_[i].node_wakeup; }
  void wait_until(std::uint32_t i, Ns time) {
    threads_[i].clock = std::max(threads_[i].clock, time);
  }
  void sensor(std::uint32_t i, std::size_t frame) { wait_for(i, messages_.sensor(i, frame)); }
  void message(std::uint32_t i, std::uint32_t input, std::size_t frame) {
    wait_for(i, messages_.message(i, input, frame));
  }
  void load(std::uint32_t) {}
  std::size_t steps(std::uint32_t i, std::size_t frame, const CompiledFrame& program,
                    std::size_t first, Ns until);
  Ns post(std::uint32_t i, std::size_t frame);

  Ns horizon() const;
  Consumption consumption() const;
  /// All but the makespan, so many times.
  void add_consumption(Consumption& sum, std::size_t times) const;
  // ---- For Repetition ---------------------------------------------------------------------------
  bool idle(Ns at) const;
  void save(Ns at, std::size_t first, std::size_t last, std::vector<Ns>& words) const;
  void forward(Ns time, std::size_t frames, std::size_t first, std::size_t last);
  void consume(const Consumption& more, std::size_t times);

  /// How many moments had to be simulated so far.
  std::size_t simulated() const { return moments_.simulated(); }
  /// False if what was driven may differ from CompiledClock: then that has to do it.
  bool exact() const { return exact_ && moments_.exact(); }

 private:
  struct Thread {
    const CompiledTask* task = nullptr;
    Ns clock = 0, queue_end = 0;
    Ns earliest = 0;  ///< running: not through before
    Ns node_wakeup = 0;
    Freedom free;
    std::uint32_t group = 0;
    bool running = false;  ///< in its group
    bool alone = false;    ///< or at work without any calendar
  };
  struct Group {
    Moment* moment = nullptr;
    Ns since = 0;
    std::vector<std::uint32_t> running;  ///< tasks
    bool bound = false;                  ///< their clocks are bounds only
  };

  void wait_for(std::uint32_t i, Ns end) {
    if (end > threads_[i].clock) threads_[i].clock = end + threads_[i].node_wakeup;
  }
  void find_groups();
  bool run_alone(Thread& t, const CompiledFrame& program);
  void join(std::uint32_t i, const CompiledFrame& program);
  void set_bounds(Group& group);
  void set_finish(Group& group);
  /// Nobody runs, and the engines are free from `time` on.
  static bool over(const Group& group, Ns time) {
    return group.running.empty() && group.moment->taken_until <= time - group.since;
  }
  void add(const AllHeld& held);

  const Compiler& compiler_;
  Moments moments_;
  Messages messages_;
  const Scene* scene_ = nullptr;
  std::vector<const CompiledTask*> tasks_;  ///< that threads and groups are of
  std::vector<Thread> threads_;
  std::vector<Group> groups_;
  std::vector<std::uint32_t> parents_;  ///< of find_groups
  Consumption used_;                    ///< so far
  bool exact_ = true;
  bool moved_ = false;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_RECALLING_CLOCK_H
