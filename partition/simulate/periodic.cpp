#include "partition/simulate/periodic.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace partita::partition {
namespace {

/// Whether the same tasks run on both frames, and do the same.
bool alike(const Pipeline& pipeline, const std::vector<const TaskWork*>& works, std::size_t a,
           std::size_t b) {
  for (std::size_t i = 0; i < works.size(); ++i) {
    const std::size_t every = pipeline.tasks[i].every, recorded = works[i]->frames.size();
    if ((a % every == 0) != (b % every == 0)) return false;
    if (a % every == 0 && a % recorded != b % recorded) return false;
  }
  return true;
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
      const auto position =
          static_cast<std::size_t>(std::max(std::ceil(share * static_cast<double>(total)), 1.0));
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
  /// `part`, a stretch that begins on an idle machine, occurs `at.count` times, first and last at
  /// those frames. False if it is not over when the next begins, where one does.
  bool add(const Scene& part, RecallingClock& clock, Trace& trace, const FrameKind& at,
           bool at_the_end = false) {
    const auto [first, last, times] = at;
    clock.reset(part);
    Driver<RecallingClock>(part, clock, trace).run();
    const Ns period = part.pipeline->period_ns;
    if (clock.horizon() > part.frames * period && !at_the_end) return false;
    if (!clock.exact() || posts_at_once(trace)) return false;
    const Figures figures = figures_of(trace, part);
    run_.figures.late += times * figures.late;
    run_.figures.dropped += times * figures.dropped;
    run_.figures.dropped_by_tasks += times * figures.dropped_by_tasks;
    partition::add(run_.consumption, clock.consumption(), times);
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
  Ns first_ = Trace::kNot;  ///< END of the first frame that was finished
  Ns last_ = 0;
};

/// A frame of each kind on an idle machine.
std::optional<PeriodicRun> by_frames(const Scene& whole, const Cycle& cycle, RecallingClock& clock,
                                     Trace& trace) {
  Sum sum;
  Scene part = whole;
  part.frames = 1;
  for (const FrameKind& kind : cycle.kinds) {
    part.offset = kind.first;
    if (!sum.add(part, clock, trace, kind)) return std::nullopt;
  }
  return sum.result();
}

/// One cycle on an idle machine, and what is left of another one at the end.
std::optional<PeriodicRun> by_cycle(const Scene& whole, std::size_t cycle, RecallingClock& clock,
                                    Trace& trace) {
  Sum sum;
  const std::size_t cycles = whole.frames / cycle, rest = whole.frames % cycle;
  Scene part = whole;
  part.frames = cycle;
  if (!sum.add(part, clock, trace, {0, (cycles - 1) * cycle, cycles})) return std::nullopt;
  part.frames = rest;
  const std::size_t tail = cycles * cycle;
  if (rest > 0 && !sum.add(part, clock, trace, {tail, tail, 1}, true)) return std::nullopt;
  return sum.result();
}

}  // namespace

Cycle cycle_of(const Pipeline& pipeline, const std::vector<const TaskWork*>& works,
               std::size_t frames) {
  Cycle cycle;
  std::size_t length = 1;
  for (std::size_t i = 0; i < works.size(); ++i) {
    for (const std::size_t count :
         {std::size_t{pipeline.tasks[i].every}, works[i]->frames.size()}) {
      length = std::lcm(length, count);
      if (length > frames) return cycle;
    }
  }
  cycle.length = length;
  for (std::size_t k = 0; k < frames; ++k) {
    const auto known =
        std::find_if(cycle.kinds.begin(), cycle.kinds.end(),
                     [&](const FrameKind& kind) { return alike(pipeline, works, kind.first, k); });
    FrameKind& kind =
        known != cycle.kinds.end() ? *known : cycle.kinds.emplace_back(FrameKind{k, k, 0});
    kind.last = k;
    ++kind.count;
  }
  return cycle;
}

std::optional<PeriodicRun> run_periodic(const Scene& scene, const Cycle& cycle,
                                        RecallingClock& clock, Trace& trace) {
  if (cycle.length == 0) return std::nullopt;
  // Frame by frame costs more a frame; it has to save many.
  if (2 * cycle.kinds.size() <= cycle.length || cycle.length == 1) {
    if (auto run = by_frames(scene, cycle, clock, trace)) return run;
  }
  return cycle.length == 1 ? std::nullopt : by_cycle(scene, cycle.length, clock, trace);
}

}  // namespace partita::partition
