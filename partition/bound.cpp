#include "partition/bound.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace partita::partition {
namespace {

std::uint64_t divided_up(std::uint64_t a, std::uint64_t b) {
  return (a + b - 1) / b;
}

/// Of `count` values, the 1-based nearest rank.
std::size_t rank(double share, std::size_t count) {
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(share * static_cast<double>(count) - 1e-9)));
}

/// Whether the task does every frame of its own, whatever is dropped elsewhere.
std::vector<bool> certain_tasks(const Pipeline& pipeline) {
  std::vector<bool> certain;
  for (const PipelineTask& task : pipeline.tasks) {
    const auto feeds = [&](const Input& input) {
      return certain[input.task] && task.every % pipeline.tasks[input.task].every == 0;
    };
    // Without any of its inputs it would skip the frame.
    const bool fed = task.inputs.empty() ||
                     std::any_of(task.inputs.begin(), task.inputs.end(), feeds) ||
                     std::all_of(task.inputs.begin(), task.inputs.end(),
                                 [&](const Input& input) { return certain[input.task]; });
    certain.push_back(task.when_full == WhenFull::keep && fed);
  }
  return certain;
}

}  // namespace

struct Bounder::Task {
  bool output = false;
  bool certain = false;
  bool precedes = false;   ///< does every finished frame, before the last output ends
  double activations = 0;  ///< at least, per finished frame; in the long run
  double counted = 0;      ///< the same in a simulation, whose last frames may not finish
  double per_frame = 0;    ///< at least, per frame of the cameras
  std::vector<std::uint32_t> producers;  ///< whose part of the same frame it waits for
  std::vector<const Least*> places;      ///< null where not a choice
  Least open;                            ///< of all choices the least of everything
  const Least& at(std::uint32_t place) const { return place == kOpen ? open : *places[place]; }
};

namespace {

Least least_of(const std::vector<const Least*>& places, std::size_t engines) {
  constexpr double kMost = std::numeric_limits<double>::max();
  Least open{kMost, kMost, {}};
  std::vector<double> busy(engines, kMost);
  for (const Least* least : places) {
    if (least == nullptr) continue;
    open.duration_ns = std::min(open.duration_ns, least->duration_ns);
    open.energy_j = std::min(open.energy_j, least->energy_j);
    std::vector<double> here(engines, 0);
    for (const Load& load : least->loads) here[load.engine] += load.busy_ns;
    for (std::size_t e = 0; e < engines; ++e) busy[e] = std::min(busy[e], here[e]);
  }
  for (std::uint32_t e = 0; e < engines; ++e) {
    if (busy[e] > 0) open.loads.push_back({e, busy[e]});
  }
  return open;
}

}  // namespace

double Bounds::cost(Objective objective) const {
  return partition::cost(objective, score());
}

Score Bounds::score() const {
  return {.p50_ns = p50_ns,
          .p99_ns = p99_ns,
          .energy_j = energy_j,
          .frame_ns = frame_ns,
          .price_usd = price_usd};
}

Bounder::Bounder(const Evaluator& evaluator, const Choices& choices)
    : evaluator_(evaluator), tasks_(choices.size()) {
  const Pipeline& pipeline = evaluator.pipeline();
  for (const std::uint32_t t : pipeline.outputs) {
    tasks_[t].output = tasks_[t].precedes = true;
    stride_ = std::lcm(stride_, pipeline.tasks[t].every);
  }
  finished_ = divided_up(evaluator.frames(), stride_);
  period_ns_ = static_cast<double>(pipeline.period_ns);
  for (std::uint32_t t = 0; t < tasks_.size(); ++t) {
    tasks_[t].places.resize(evaluator.places(t).size());
    for (const std::uint32_t p : choices[t]) tasks_[t].places[p] = &evaluator.least(t, p);
    tasks_[t].open = least_of(tasks_[t].places, evaluator.engines().size());
  }
  find_required();
}

Bounder::~Bounder() = default;

/// Which tasks did their part of every finished frame: the outputs, what they wait for.
void Bounder::find_required() {
  const Pipeline& pipeline = evaluator_.pipeline();
  const std::vector<bool> certain = certain_tasks(pipeline);
  std::vector<bool> required(tasks_.size(), false);
  for (std::uint32_t t = static_cast<std::uint32_t>(tasks_.size()); t-- > 0;) {
    Task& task = tasks_[t];
    const PipelineTask& what = pipeline.tasks[t];
    const bool runs = stride_ % what.every == 0;
    task.certain = certain[t];
    required[t] = required[t] || task.output || (certain[t] && runs);
    // A producer that dropped the frame is not waited for, unless nothing else starts the task.
    for (const Input& input : what.inputs) {
      if (!required[t] || stride_ % pipeline.tasks[input.task].every != 0) continue;
      if (!certain[input.task] && what.inputs.size() > 1) continue;
      required[input.task] = true;
      task.producers.push_back(input.task);
      if (task.precedes) tasks_[input.task].precedes = true;
    }
    const double every = what.every, stride = stride_;
    const double finished = static_cast<double>(finished_);
    const auto done = static_cast<double>(divided_up(evaluator_.frames(), what.every));
    task.activations = certain[t] ? stride / every : required[t] ? 1 : 0;
    task.counted = certain[t] ? done / finished : required[t] ? 1 : 0;
    task.per_frame = certain[t] ? 1 / every : 0;
    drops_ = drops_ || (task.output && !certain[t]);
  }
}

double Bounder::path(const TaskPlacement& placement) const {
  std::vector<double> end(tasks_.size(), 0);
  double longest = 0;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    for (const std::uint32_t producer : tasks_[t].producers) {
      end[t] = std::max(end[t], end[producer]);
    }
    end[t] += tasks_[t].at(placement[t]).duration_ns;
    if (tasks_[t].output) longest = std::max(longest, end[t]);
  }
  return longest;
}

/// Fills what follows from the work on engines and from tasks that do one frame after the other.
void Bounder::add_loads(const TaskPlacement& placement, Bounds& bounds) const {
  const std::size_t engines = evaluator_.engines().size();
  std::vector<double> in_frame(engines, 0), of_finished(engines, 0), of_all(engines, 0);
  double longest = 0;  // of what has to be done for each frame of the cameras
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    const Task& task = tasks_[t];
    const Least& least = task.at(placement[t]);
    bounds.frame_ns = std::max(bounds.frame_ns, least.duration_ns * task.activations);
    if (task.precedes) longest = std::max(longest, least.duration_ns * task.per_frame);
    for (const Load& load : least.loads) {
      of_finished[load.engine] += load.busy_ns * task.activations;
      if (!task.precedes) continue;
      in_frame[load.engine] += load.busy_ns;
      of_all[load.engine] += load.busy_ns * task.per_frame;
    }
  }
  for (std::size_t e = 0; e < engines; ++e) {
    bounds.load_ns = std::max(bounds.load_ns, in_frame[e]);
    bounds.frame_ns = std::max(bounds.frame_ns, of_finished[e]);
    longest = std::max(longest, of_all[e]);
  }
  bounds.p50_ns = bounds.p99_ns = std::max(bounds.path_ns, bounds.load_ns);
  if (drops_ || longest <= period_ns_) return;
  // Finished frame number r is frame k = (r - 1) stride: all work of frames 0..k lies before its
  // end, and none before the first trigger. Latencies grow with k, so r is the rank as well.
  const auto waited = [&](double share) {
    const auto k = static_cast<double>((rank(share, finished_) - 1) * stride_);
    return (k + 1) * longest - k * period_ns_;
  };
  bounds.p50_ns = std::max(bounds.p50_ns, waited(0.5));
  bounds.p99_ns = std::max(bounds.p99_ns, waited(0.99));
}

double Bounder::price(const TaskPlacement& placement) const {
  const profile::Machine& machine = evaluator_.machine();
  std::vector<bool> devices(machine.devices.size()), nodes(machine.nodes.size());
  for (std::uint32_t t = 0; t < placement.size(); ++t) {
    if (placement[t] == kOpen) continue;
    const Place& place = evaluator_.places(t)[placement[t]];
    if (place.is_device && !machine.devices[place.index].is_host_cpu) devices[place.index] = true;
    nodes[place.is_device ? machine.devices[place.index].node : place.index] = true;
  }
  double sum = 0;
  for (std::size_t d = 0; d < devices.size(); ++d) {
    if (devices[d]) sum += machine.devices[d].profile.price_usd;
  }
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n]) sum += machine.nodes[n].host.price_usd;
  }
  return sum;
}

Bounds Bounder::operator()(const TaskPlacement& placement) const {
  Bounds bounds;
  bounds.finished = finished_;
  bounds.frame_ns = period_ns_ * stride_;
  bounds.path_ns = path(placement);
  add_loads(placement, bounds);
  // n finished frames take at least n - 1 of their periods from the first trigger on.
  const auto n = static_cast<double>(finished_);
  bounds.energy_j = evaluator_.least_power_w() * period_ns_ * stride_ * 1e-9 * (n - 1) / n;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    bounds.energy_j += tasks_[t].at(placement[t]).energy_j * tasks_[t].counted;
  }
  bounds.price_usd = price(placement);
  return bounds;
}

Bounds Bounder::root() const {
  return (*this)(TaskPlacement(tasks_.size(), kOpen));
}

}  // namespace partita::partition
