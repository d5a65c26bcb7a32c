#include "partition/search/bound.h"

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
  bool precedes = false;                 ///< does every finished frame, before the last output ends
  double activations = 0;                ///< if it precedes: per finished frame, at least
  double per_frame = 0;                  ///< per frame of the cameras that is not dropped, at least
  std::vector<std::uint32_t> producers;  ///< whose part of the same frame it waits for
  std::vector<const Least*> places;      ///< null where not a choice
  Least open;                            ///< of all choices the least of everything
  const Least& at(std::uint32_t place) const { return place == kOpen ? open : *places[place]; }
  /// The mean counts where all frames are done; else those that are done may be the light ones.
  double typical(const AtLeast& figure) const { return certain ? figure.mean : figure.any; }
};

namespace {

constexpr AtLeast kMost{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};

void lower(AtLeast& to, const AtLeast& other) {
  to.any = std::min(to.any, other.any);
  to.mean = std::min(to.mean, other.mean);
}

Least least_of(const std::vector<const Least*>& places, std::size_t engines) {
  Least open{kMost, kMost, {}};
  std::vector<AtLeast> busy(engines, kMost);
  for (const Least* least : places) {
    if (least == nullptr) continue;
    lower(open.duration_ns, least->duration_ns);
    lower(open.energy_j, least->energy_j);
    std::vector<AtLeast> here(engines);
    for (const Load& load : least->loads) {
      here[load.engine].any += load.busy_ns.any;
      here[load.engine].mean += load.busy_ns.mean;
    }
    for (std::size_t e = 0; e < engines; ++e) lower(busy[e], here[e]);
  }
  for (std::uint32_t e = 0; e < engines; ++e) {
    if (busy[e].mean > 0) open.loads.push_back({e, busy[e]});
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

Bounder::Bounder(const Evaluator& evaluator, const Choices& choices, Drops drops)
    : evaluator_(evaluator), tasks_(choices.size()) {
  const Pipeline& pipeline = evaluator.pipeline();
  for (const std::uint32_t t : pipeline.outputs) {
    tasks_[t].output = tasks_[t].precedes = true;
    stride_ = std::lcm(stride_, pipeline.tasks[t].every);
  }
  finished_ = divided_up(evaluator.frames(), stride_);
  period_ns_ = static_cast<double>(pipeline.period_ns);
  for (const PipelineTask& task : pipeline.tasks) {
    // Does the frame or, busy when it came, drops it: its clock has passed the trigger either way.
    const std::uint64_t last = (evaluator.frames() - 1) / task.every * task.every;
    if (task.inputs.empty()) {
      last_trigger_ns_ = std::max(last_trigger_ns_, static_cast<double>(last) * period_ns_);
    }
  }
  for (std::uint32_t t = 0; t < tasks_.size(); ++t) {
    tasks_[t].places.resize(evaluator.places(t).size());
    for (const std::uint32_t p : choices[t]) tasks_[t].places[p] = &evaluator.least(t, p);
    tasks_[t].open = least_of(tasks_[t].places, evaluator.engines().size());
  }
  find_required(drops == Drops::none ? std::vector<bool>(tasks_.size(), true)
                                     : certain_tasks(pipeline));
}

Bounder::~Bounder() = default;

/// Which tasks did their part of every finished frame: the outputs, what they wait for.
void Bounder::find_required(const std::vector<bool>& certain) {
  const Pipeline& pipeline = evaluator_.pipeline();
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
    const double every = what.every;
    task.activations = certain[t] ? stride_ / every : 1;
    // With outputs on every frame, what is not dropped is finished.
    task.per_frame = certain[t] ? 1 / every : required[t] && stride_ == 1 ? 1 : 0;
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
    end[t] += tasks_[t].at(placement[t]).duration_ns.any;
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
    if (!task.precedes) continue;
    const Least& least = task.at(placement[t]);
    const double share = task.certain ? task.per_frame : 0;
    bounds.frame_ns = std::max(bounds.frame_ns, task.typical(least.duration_ns) * task.activations);
    longest = std::max(longest, least.duration_ns.any * share);
    for (const Load& load : least.loads) {
      in_frame[load.engine] += load.busy_ns.any;
      of_finished[load.engine] += task.typical(load.busy_ns) * task.activations;
      of_all[load.engine] += load.busy_ns.any * share;
    }
  }
  for (std::size_t e = 0; e < engines; ++e) {
    bounds.load_ns = std::max(bounds.load_ns, in_frame[e]);
    bounds.frame_ns = std::max(bounds.frame_ns, of_finished[e]);
    longest = std::max(longest, of_all[e]);
  }
  bounds.p50_ns = bounds.p99_ns = std::max(bounds.path_ns, bounds.load_ns);
  if (!drops_) add_waiting(longest, bounds);
}

/// Finished frame number r is frame k = (r - 1) stride: all work of frames 0..k lies before its
/// end, and none before the first trigger.
void Bounder::add_waiting(double longest, Bounds& bounds) const {
  const auto end = [&](std::size_t r) {
    return (static_cast<double>((r - 1) * stride_) + 1) * longest;
  };
  bounds.makespan_ns = std::max(bounds.makespan_ns, end(finished_));
  if (longest <= period_ns_) return;
  // Latencies grow from frame to frame: r is the rank as well.
  const auto waited = [&](double share) {
    const std::size_t r = rank(share, finished_);
    return end(r) - static_cast<double>((r - 1) * stride_) * period_ns_;
  };
  bounds.p50_ns = std::max(bounds.p50_ns, waited(0.5));
  bounds.p99_ns = std::max(bounds.p99_ns, waited(0.99));
}

/// What the parts in use cost, and draw when idle.
void Bounder::add_parts(const TaskPlacement& placement, Bounds& bounds) const {
  const profile::Machine& machine = evaluator_.machine();
  std::vector<bool> devices(machine.devices.size()), nodes(machine.nodes.size());
  nodes[machine.sensor_node] = true;
  for (std::uint32_t t = 0; t < placement.size(); ++t) {
    if (placement[t] == kOpen) continue;
    const Place& place = evaluator_.places(t)[placement[t]];
    if (place.is_device && !machine.devices[place.index].is_host_cpu) devices[place.index] = true;
    nodes[place.is_device ? machine.devices[place.index].node : place.index] = true;
  }
  double idle_w = 0;
  const auto add = [&](const profile::DeviceProfile& part) {
    bounds.price_usd += part.price_usd;
    idle_w += part.power.idle_w;
  };
  for (std::size_t d = 0; d < devices.size(); ++d) {
    if (devices[d]) add(machine.devices[d].profile);
  }
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n]) add(machine.nodes[n].host);
  }
  bounds.energy_j += idle_w * bounds.makespan_ns * 1e-9 / static_cast<double>(evaluator_.frames());
}

Bounds Bounder::operator()(const TaskPlacement& placement) const {
  Bounds bounds;
  bounds.finished = finished_;
  bounds.frame_ns = period_ns_ * stride_;
  bounds.makespan_ns = last_trigger_ns_;
  bounds.path_ns = path(placement);
  add_loads(placement, bounds);
  add_parts(placement, bounds);
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    const Task& task = tasks_[t];
    bounds.energy_j += task.typical(task.at(placement[t]).energy_j) * task.per_frame;
  }
  return bounds;
}

Bounds Bounder::root() const {
  return (*this)(TaskPlacement(tasks_.size(), kOpen));
}

}  // namespace partita::partition
