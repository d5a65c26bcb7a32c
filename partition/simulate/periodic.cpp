#include "partition/simulate/periodic.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace partita::partition {
namespace {

/// What is posted at time 0 finds its reader awake, as at no later frame.
bool posts_at_once(const Trace& trace) {
  return std::any_of(trace.tasks.begin(), trace.tasks.end(),
                     [](const Trace::Task& task) { return task.end.front() == 0; });
}

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

Distribution Weighted::distribution() {
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

void Periodic::clear() {
  run_.figures = {};
  Consumption& used = run_.consumption;
  for (auto* all : {&used.device_busy, &used.node_busy, &used.device_bytes, &used.node_bytes,
                    &used.link_bytes}) {
    all->clear();
  }
  used.makespan = 0;
  latency_.clear();
  perception_.clear();
  finished_ = 0;
  first_ = Trace::kNot;
  last_ = 0;
}

/// A frame, simulated on an idle machine, occurs as often as `kind` says. False if it is not over
/// when the next one begins.
bool Periodic::add(const FrameKind& kind) {
  frame_.offset = kind.first;
  clock_.reset(frame_);
  driver_.run();
  const Ns period = frame_.pipeline->period_ns, horizon = clock_.horizon();
  if (horizon > period || !clock_.exact() || posts_at_once(trace_)) return false;
  Figures figures;
  count_frames(trace_, frame_, figures);
  run_.figures.late += kind.count * figures.late;
  run_.figures.dropped += kind.count * figures.dropped;
  run_.figures.dropped_by_tasks += kind.count * figures.dropped_by_tasks;
  clock_.add_consumption(run_.consumption, kind.count);
  run_.consumption.makespan = std::max(run_.consumption.makespan, kind.last * period + horizon);
  const Ns end = last_end(trace_, frame_.pipeline->outputs, 0);
  const Ns perceived = last_end(trace_, frame_.pipeline->perception, 0);
  if (perceived != Trace::kNot) perception_.add(perceived, kind.count);
  if (end == Trace::kNot) return true;
  latency_.add(end, kind.count);
  finished_ += kind.count;
  first_ = std::min(first_, kind.first * period + end);
  last_ = std::max(last_, kind.last * period + end);
  return true;
}

void Periodic::finish() {
  run_.figures.latency = latency_.distribution();
  run_.figures.perception = perception_.distribution();
  run_.figures.throughput_hz = rate_of(finished_, first_, last_);
}

const PeriodicRun* Periodic::run(const Scene& scene, const Cycle& cycle) {
  // Frame by frame costs more a frame; it has to save many.
  if (cycle.length == 0 || (2 * cycle.kinds.size() > cycle.length && cycle.length > 1)) {
    return nullptr;
  }
  clear();
  frame_ = scene;
  frame_.frames = 1;
  for (const FrameKind& kind : cycle.kinds) {
    if (!add(kind)) return nullptr;
  }
  finish();
  return &run_;
}

}  // namespace partita::partition
