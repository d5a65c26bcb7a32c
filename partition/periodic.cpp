#include "partition/periodic.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace partita::partition {
namespace {

/// Equal frames of a cycle: the first and the last of them, and how many there are.
struct Kind {
  std::uint64_t tasks = 0;  ///< a bit for each that runs
  std::size_t first = 0, last = 0, count = 0;
};

std::vector<Kind> kinds_of(const Scene& scene, std::size_t cycle) {
  std::vector<Kind> kinds;
  for (std::size_t k = 0; k < cycle; ++k) {
    std::uint64_t tasks = 0;
    for (std::uint32_t i = 0; i < scene.tasks.size(); ++i) {
      tasks |= std::uint64_t{scene.runs(i, k)} << i;
    }
    auto known =
        std::find_if(kinds.begin(), kinds.end(), [&](const Kind& x) { return x.tasks == tasks; });
    if (known == kinds.end()) known = kinds.insert(known, {tasks, k, k, 0});
    known->last = k;
    ++known->count;
  }
  return kinds;
}

/// Values with how often each occurs; the same figures as distribution() of all of them.
class Weighted {
 public:
  void add(Ns value, std::size_t count) { values_.push_back({value, count}); }
  Distribution distribution() {
    Distribution d;
    std::size_t total = 0;
    double sum = 0;
    std::sort(values_.begin(), values_.end());
    for (const auto& [value, count] : values_) {
      total += count;
      sum += static_cast<double>(value) * static_cast<double>(count);
    }
    if (total == 0) return d;
    const auto rank = [&](double share) {
      const auto position = static_cast<std::size_t>(
          std::max(std::ceil(share * static_cast<double>(total)), 1.0));
      std::size_t before = 0;
      for (const auto& [value, count] : values_) {
        before += count;
        if (before >= position) return value;
      }
      return values_.back().first;
    };
    d.mean = sum / static_cast<double>(total);
    d.p50 = rank(0.50);
    d.p99 = rank(0.99);
    d.max = values_.back().first;
    return d;
  }

 private:
  std::vector<std::pair<Ns, std::size_t>> values_;
};

void add(std::vector<std::uint64_t>& sum, const std::vector<std::uint64_t>& more,
         std::size_t times) {
  sum.resize(more.size(), 0);
  for (std::size_t i = 0; i < more.size(); ++i) sum[i] += times * more[i];
}

void add(Consumption& sum, const Consumption& more, std::size_t times) {
  add(sum.device_busy, more.device_busy, times);
  add(sum.node_busy, more.node_busy, times);
  add(sum.device_bytes, more.device_bytes, times);
  add(sum.node_bytes, more.node_bytes, times);
  add(sum.link_bytes, more.link_bytes, times);
}

/// Collects the stretches of frames that the whole is made of.
class Sum {
 public:
  /// `part`, a stretch that begins on an idle machine, occurs `times` times, at frame `first` for
  /// the first time and at frame `last` for the last. False if it is not over when the next begins.
  bool add(const Scene& part, CompiledClock& clock, Trace& trace, std::size_t first,
           std::size_t last, std::size_t times) {
    clock.reset(part);
    Driver<CompiledClock>(part, clock, trace).run();
    const Ns period = part.pipeline->period_ns;
    if (clock.horizon() > part.frames * period || posts_at_once(trace)) return false;
    const Figures figures = figures_of(trace, part);
    run_.figures.late += times * figures.late;
    run_.figures.dropped += times * figures.dropped;
  run_.figures.dropped_by_tasks += times * figures.dropped_by_tasks;
    partition::add(run_.consumption, clock.consumption(trace), times);
    run_.consumption.makespan =
        std::max(run_.consumption.makespan, last * period + clock.horizon());
    for (std::size_t k = 0; k < part.frames; ++k) {
      const Ns end = last_end(trace, part.pipeline->outputs, k);
      const Ns perceived = last_end(trace, part.pipeline->perception, k);
      if (perceived != Trace::kNot) perception_.add(perceived - k * period, times);
      if (end == Trace::kNot) continue;
      latency_.add(end - k * period, times);
      finished_ += times;
      first_ = std::min(first_, first * period + end);
      last_ = std::max(last_, last * period + end);
    }
    return true;
  }

  /// What is posted at time 0 finds its reader awake, as at no later frame.
  static bool posts_at_once(const Trace& trace) {
    return std::any_of(trace.tasks.begin(), trace.tasks.end(),
                       [](const Trace::Task& task) { return task.end.front() == 0; });
  }

  PeriodicRun result() {
    run_.figures.latency = latency_.distribution();
    run_.figures.perception = perception_.distribution();
    run_.figures.throughput_hz = rate_of(finished_, first_, last_);
    return std::move(run_);
  }

 private:
  PeriodicRun run_;
  Weighted latency_, perception_;
  std::size_t finished_ = 0;
  Ns first_ = Trace::kNot, last_ = 0;
};

/// A frame of each kind on an idle machine.
std::optional<PeriodicRun> by_frames(const Scene& whole, std::size_t cycle, CompiledClock& clock,
                                     Trace& trace) {
  Sum sum;
  const std::size_t cycles = whole.frames / cycle;
  Scene part = whole;
  part.frames = 1;
  for (const Kind& kind : kinds_of(whole, cycle)) {
    if (kind.tasks == 0) continue;
    part.offset = kind.first;
    if (!sum.add(part, clock, trace, kind.first, (cycles - 1) * cycle + kind.last,
                 cycles * kind.count)) {
      return std::nullopt;
    }
  }
  return sum.result();
}

/// One cycle on an idle machine.
std::optional<PeriodicRun> by_cycle(const Scene& whole, std::size_t cycle, CompiledClock& clock,
                                    Trace& trace) {
  Sum sum;
  const std::size_t cycles = whole.frames / cycle;
  Scene part = whole;
  part.frames = cycle;
  if (!sum.add(part, clock, trace, 0, (cycles - 1) * cycle, cycles)) return std::nullopt;
  return sum.result();
}

}  // namespace

std::size_t cycle_of(const Pipeline& pipeline) {
  constexpr std::size_t kLongest = 10'000;
  std::size_t cycle = 1;
  for (const PipelineTask& task : pipeline.tasks) {
    cycle = std::lcm(cycle, std::size_t{task.every});
    if (cycle > kLongest) {
      throw profile::Error("pipeline '" + pipeline.id +
                           "': its tasks run together every more than 10000 frames, expected fewer");
    }
  }
  return cycle;
}

std::optional<PeriodicRun> run_periodic(const Scene& scene, CompiledClock& clock, Trace& trace) {
  const bool swaps = std::find(scene.swaps.begin(), scene.swaps.end(), true) != scene.swaps.end();
  if (swaps || scene.tasks.size() > 64) return std::nullopt;  // a bitstream outlives its frame
  const std::size_t cycle = cycle_of(*scene.pipeline);
  std::optional<PeriodicRun> run = by_frames(scene, cycle, clock, trace);
  return run || cycle == 1 ? run : by_cycle(scene, cycle, clock, trace);
}

}  // namespace partita::partition
