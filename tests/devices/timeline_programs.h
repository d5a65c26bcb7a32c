// Random OpenCL-like programs for the timeline's property tests: deterministic from a seed.
#ifndef PARTITA_TESTS_DEVICES_TIMELINE_PROGRAMS_H
#define PARTITA_TESTS_DEVICES_TIMELINE_PROGRAMS_H

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "devices/timeline/schedule.h"
#include "devices/timeline/timeline.h"

namespace partita::timeline::test {

/// Two nodes: "soc" with a GPU that shares its memory, "pc" with an FPGA of its own memory and a
/// discrete GPU, and with both CPUs as devices.
inline Layout small_layout() {
  Layout l;
  l.machine = "test";
  l.nodes = {{"soc", 2, 10'000'000'000, 6'000'000'000, 100, 300},
             {"pc", 3, 20'000'000'000, 8'000'000'000, 50, 200}};
  using profile::DeviceType;
  l.devices = {
      {"gpu0", DeviceType::gpu, 0, false, true, 10'000'000'000, 2'000'000'000, 400, 100, 150, 300},
      {"cpu0", DeviceType::cpu, 0, true, true, 10'000'000'000, 4'000'000'000, 10, 30, 20, 40},
      {"fpga", DeviceType::fpga, 1, false, false, 12'000'000'000, 5'000'000'000, 700, 200, 250,
       500},
      {"gpu1", DeviceType::gpu, 1, false, false, 90'000'000'000, 9'000'000'000, 600, 80, 90, 100},
      {"cpu1", DeviceType::cpu, 1, true, true, 20'000'000'000, 7'000'000'000, 10, 30, 20, 40}};
  l.links = {{"lan", 0, 1, 100'000'000, 5000}};
  return l;
}

struct ProgramOptions {
  int threads = 1;
  int steps = 200;
  bool user_events = true;
  bool out_of_order = true;
};

/// One host thread's program; `act` performs its next step.
class Program {
 public:
  Program(Timeline& timeline, std::uint32_t seed, std::uint32_t rank, const ProgramOptions& options)
      : timeline_(timeline), random_(seed), options_(options) {
    const std::string own = std::string("t").append(std::to_string(rank));
    thread_ = timeline.add_thread(own);
    timeline.bind_thread(thread_, own, rank, pick(5));
    for (DeviceId d = 0; d < 5; ++d) {
      queues_.push_back(timeline.add_queue(d, false));
      if (options.out_of_order) queues_.push_back(timeline.add_queue(d, true));
    }
  }

  void act() {
    const auto dice = pick(100);
    if (dice < 70) return enqueue();
    if (dice < 76) return wait();
    if (dice < 79) {
      timeline_.finish(thread_, queues_[pick(queues_.size())]);
    } else if (dice < 83) {
      add(timeline_.host_step(thread_, name("step"), demand(false)));
    } else if (dice < 86) {
      add(timeline_.sensor_input(thread_, name("sensor"), pick(100'000)));
    } else if (dice < 88) {
      timeline_.wait_until(thread_, trigger_ += pick(40'000));  // no live clock: it may race
    } else if (dice < 92 && options_.user_events) {
      events_.push_back(timeline_.create_user_event(thread_));
      nodes_.push_back(events_.back());
    } else if (dice < 97 && !events_.empty()) {
      const std::size_t i = pick(events_.size());
      timeline_.set_user_event(thread_, events_[i], pick(6) == 0 ? -5 : 0);
      events_.erase(events_.begin() + static_cast<std::ptrdiff_t>(i));
    } else if (!nodes_.empty()) {
      timeline_.observe(thread_, nodes_[pick(nodes_.size())]);
    }
  }

  void end() {
    for (const NodeId event : events_) timeline_.set_user_event(thread_, event, 0);
    for (const QueueId queue : queues_) timeline_.finish(thread_, queue);
  }

  ThreadId thread() const { return thread_; }
  const std::vector<NodeId>& nodes() const { return nodes_; }
  std::vector<std::vector<NodeId>> waits;  ///< by order of nodes_, of enqueued commands

 private:
  std::size_t pick(std::size_t n) { return random_() % n; }
  NameId name(const std::string& what) { return timeline_.intern(what + std::to_string(pick(3))); }
  void add(NodeId node) { nodes_.push_back(node); }

  Demand demand(bool parallel) {
    Demand d;
    d.launch_ns = pick(3) * 100;
    d.compute_ns = pick(5'000);
    d.memory_ns = pick(5'000);
    d.bytes = d.memory_ns * (1 + pick(9));
    d.units = parallel ? 1 + static_cast<std::uint32_t>(pick(4)) : 1;
    return d;
  }

  std::vector<NodeId> some_nodes() {
    std::vector<NodeId> list;
    for (std::size_t n = pick(3); n > 0 && !nodes_.empty(); --n) {
      const std::size_t back = 1 + pick(std::min<std::size_t>(nodes_.size(), 12));
      list.push_back(nodes_[nodes_.size() - back]);
    }
    return list;
  }

  void enqueue() {
    static constexpr CommandKind kKinds[] = {
        CommandKind::kernel, CommandKind::kernel, CommandKind::kernel, CommandKind::write,
        CommandKind::read,   CommandKind::map,    CommandKind::unmap,  CommandKind::copy,
        CommandKind::fill,   CommandKind::marker, CommandKind::barrier};
    Command c;
    c.queue = queues_[pick(queues_.size())];
    c.kind = pick(80) == 0 ? CommandKind::load : kKinds[pick(std::size(kKinds))];
    c.name = name("k");
    c.compute_units = 1 + static_cast<std::uint32_t>(pick(2));
    c.demand = demand(true);
    c.bytes = pick(4) == 0 ? 0 : pick(30'000);
    const std::vector<NodeId> list = some_nodes();
    c.waits = list;
    add(timeline_.enqueue(thread_, c));
  }

  void wait() {
    const std::vector<NodeId> list = some_nodes();
    timeline_.wait(thread_, list);
  }

  Timeline& timeline_;
  std::mt19937 random_;
  ProgramOptions options_;
  ThreadId thread_ = 0;
  Ns trigger_ = 0;
  std::vector<QueueId> queues_;
  std::vector<NodeId> nodes_;
  std::vector<NodeId> events_;
};

/// Runs one program per thread, interleaved at random by `interleaving`; a thread that ends frees
/// what it holds. Queues and names are made in a fixed order, so that only the interleaving varies.
inline Record run_programs(std::uint32_t seed, std::uint32_t interleaving,
                           const ProgramOptions& options,
                           std::vector<Occupation>* occupations = nullptr) {
  Timeline timeline(small_layout(), {.record = true, .occupations = occupations});
  for (const char* what : {"k", "step", "sensor"}) {
    for (int i = 0; i < 3; ++i) timeline.intern(what + std::to_string(i));
  }
  std::vector<std::unique_ptr<Program>> programs;
  for (int t = 0; t < options.threads; ++t) {
    programs.push_back(std::make_unique<Program>(timeline,
                                                 seed * 31 + static_cast<std::uint32_t>(t),
                                                 static_cast<std::uint32_t>(t), options));
  }
  std::mt19937 order(interleaving);
  std::vector<int> left(programs.size(), options.steps);
  for (int remaining = options.steps * options.threads; remaining > 0;) {
    const std::size_t t = order() % programs.size();
    if (left[t] == 0) continue;
    programs[t]->act();
    --left[t];
    --remaining;
  }
  for (auto& program : programs) program->end();
  return timeline.snapshot();
}

}  // namespace partita::timeline::test

#endif  // PARTITA_TESTS_DEVICES_TIMELINE_PROGRAMS_H
