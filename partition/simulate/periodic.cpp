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

/// Collects the frames that the whole is made of.
class Sum {
 public:
  /// `frame`, simulated on an idle machine, occurs as often as `kind` says. False if it is not over
  /// when the next one begins.
  bool add(const Scene& frame, const RecallingClock& clock, const Trace& trace,
           const FrameKind& kind) {
    const Ns period = frame.pipeline->period_ns;
    if (clock.horizon() > period || !clock.exact()) return false;
    if (Repetition::posts_at_once(trace)) return false;
    Figures figures;
    count_frames(trace, frame, figures);
    run_.figures.late += kind.count * figures.late;
    run_.figures.dropped += kind.count * figures.dropped;
    run_.figures.dropped_by_tasks += kind.count * figures.dropped_by_tasks;
    clock.add_consumption(run_.consumption, kind.count);
    run_.consumption.makespan =
        std::max(run_.consumption.makespan, kind.last * period + clock.horizon());
    const Ns end = last_end(trace, frame.pipeline->outputs, 0);
    const Ns perceived = last_end(trace, frame.pipeline->perception, 0);
    if (perceived != Trace::kNot) perception_.add(perceived, kind.count);
    if (end == Trace::kNot) return true;
    latency_.add(end, kind.count);
    finished_ += kind.count;
    first_ = std::min(first_, kind.first * period + end);
    last_ = std::max(last_, kind.last * period + end);
    return true;
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
  // Frame by frame costs more a frame; it has to save many.
  if (cycle.length == 0 || (2 * cycle.kinds.size() > cycle.length && cycle.length > 1)) {
    return std::nullopt;
  }
  Sum sum;
  Scene frame = scene;
  frame.frames = 1;
  Driver<RecallingClock> driver(frame, clock, trace);
  for (const FrameKind& kind : cycle.kinds) {
    frame.offset = kind.first;
    clock.reset(frame);
    driver.run();
    if (!sum.add(frame, clock, trace, kind)) return std::nullopt;
  }
  return sum.result();
}

}  // namespace partita::partition
