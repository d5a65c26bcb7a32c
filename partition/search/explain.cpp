#include "partition/search/explain.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "partition/search/sanity.h"
#include "partition/text.h"
#include "partition/search/usage.h"

namespace partita::partition {
namespace {

/// From the slowest output back along the input that came last.
std::vector<PathStep> critical_path(const Evaluator& evaluator, const TaskPlacement& placement,
                                    const Figures& figures) {
  const Pipeline& pipeline = evaluator.pipeline();
  const auto end = [&](std::uint32_t t) { return figures.tasks[t].latency.mean; };
  const auto earlier = [&](std::uint32_t a, std::uint32_t b) { return end(a) < end(b); };
  std::vector<PathStep> path;
  std::uint32_t t = *std::max_element(pipeline.outputs.begin(), pipeline.outputs.end(), earlier);
  for (;;) {
    const PipelineTask& task = pipeline.tasks[t];
    std::vector<std::uint32_t> before;
    for (const Input& input : task.inputs) {
      if (task.every % pipeline.tasks[input.task].every == 0) before.push_back(input.task);
    }
    const auto last = std::max_element(before.begin(), before.end(), earlier);
    const double ready = last == before.end() ? 0 : end(*last);
    const TaskFigures& own = figures.tasks[t];
    path.push_back({task.name, evaluator.places(t)[placement[t]].name,
                    std::max(0.0, own.latency.mean - own.duration.mean - ready), own.duration.mean,
                    own.alone_ns});
    if (last == before.end()) break;
    t = *last;
  }
  std::reverse(path.begin(), path.end());
  return path;
}

struct Knob {
  std::string what;
  Speeds speeds;
};

/// One thing of those that the placement uses twice as fast, in each.
std::vector<Knob> knobs(const Evaluator& evaluator, const TaskPlacement& placement, double speed) {
  const profile::Machine& machine = evaluator.machine();
  const Usage used = usage(evaluator, placement);
  std::vector<Knob> result;
  const auto knob = [&](std::string what) -> Speeds& {
    return result.emplace_back(Knob{std::move(what), as_declared(machine)}).speeds;
  };
  for (std::size_t d = 0; d < machine.devices.size(); ++d) {
    if (!used.devices[d]) continue;
    const std::string& name = machine.devices[d].name;
    knob(name).devices[d] = speed;
    knob("bus of " + name).buses[d] = speed;
  }
  for (std::size_t n = 0; n < machine.nodes.size(); ++n) {
    if (!used.nodes[n]) continue;
    Speeds& speeds = knob(machine.nodes[n].name + "/" + machine.nodes[n].host.id);
    speeds.nodes[n] = speed;
    for (std::size_t d = 0; d < machine.devices.size(); ++d) {
      const profile::MachineDevice& device = machine.devices[d];
      if (device.is_host_cpu && device.node == n) speeds.devices[d] = speeds.buses[d] = speed;
    }
  }
  for (std::size_t l = 0; l < machine.links.size(); ++l) {
    if (used.links[l]) knob(machine.links[l].name).links[l] = speed;
  }
  return result;
}

std::vector<Sensitivity> sensitivities(const Evaluator& evaluator, const TaskPlacement& placement,
                                       const Score& score, Objective objective) {
  Choices only;
  for (const std::uint32_t place : placement) only.push_back({place});
  std::vector<Sensitivity> result;
  for (const Knob& knob : knobs(evaluator, placement, Sensitivity{}.speed)) {
    const auto faster = evaluator.with(knob.speeds);
    Sensitivity s;
    s.what = knob.what;
    const Figures figures = faster->quick(placement);
    s.score =
        score_of(*faster, placement, figures, Bounder(*faster, only, drops_of(figures))(placement));
    const double change = value(objective, s.score) - value(objective, score);
    s.gain = objective == Objective::throughput ? change : -change;
    s.relative_gain = s.gain / value(objective, score);
    result.push_back(s);
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const Sensitivity& a, const Sensitivity& b) { return a.gain > b.gain; });
  return result;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f %%", 100 * share);
  return text;
}

std::string milliseconds(double ns) {
  return show(Objective::latency, ns);
}

std::string path_line(const std::vector<PathStep>& path) {
  std::string text = "critical path: ";
  for (std::size_t i = 0; i < path.size(); ++i) {
    const PathStep& step = path[i];
    text += (i == 0 ? "" : ", then ") + step.task + " on " + step.place + " " +
            milliseconds(step.duration_ns);
    // Less would not show in the two decimals.
    constexpr double kVisible = 5e3;
    const double beside = step.duration_ns - step.alone_ns;
    if (step.alone_ns > 0 && beside > kVisible) {
      text += " (" + milliseconds(step.alone_ns) + " alone)";
    }
    if (step.waited_ns > kVisible) text += " after waiting " + milliseconds(step.waited_ns);
  }
  return text;
}

/// Empty if every task does all its frames.
std::string drops_line(const Evaluator& evaluator, const Figures& figures) {
  std::string text;
  for (std::size_t t = 0; t < figures.tasks.size(); ++t) {
    if (figures.tasks[t].dropped == 0) continue;
    const PipelineTask& task = evaluator.pipeline().tasks[t];
    const std::size_t due = (evaluator.frames() + task.every - 1) / task.every;
    append(text, task.name + " drops " + std::to_string(figures.tasks[t].dropped) + " of " +
                     std::to_string(due) + " frames");
  }
  return text.empty() ? text : "cannot keep up: " + text;
}

std::string help_line(const std::vector<Sensitivity>& sensitivities, Objective objective) {
  // Below half a percent, twice the speed is no reason to buy anything.
  constexpr double kWorthwhile = 5e-3;
  std::string text;
  for (const Sensitivity& s : sensitivities) {
    if (s.relative_gain < kWorthwhile) break;
    text += (text.empty() ? "" : "; ") + s.what +
            " twice as fast: " + show(objective, value(objective, s.score)) + " (" +
            percent(s.relative_gain) + " better)";
  }
  return text.empty() ? "nothing in use, twice as fast, would help" : "what would help: " + text;
}

}  // namespace

Explanation explain(const Evaluator& evaluator, const TaskPlacement& placement,
                    const Figures& figures, const Score& score, Objective objective) {
  Explanation e;
  e.critical_path = critical_path(evaluator, placement, figures);
  e.lines.push_back(path_line(e.critical_path));
  if (!figures.engines.empty()) {
    e.busiest_engine = figures.engines.front().name;
    e.busiest_share = figures.engines.front().share;
    e.lines.push_back("busiest engine: " + e.busiest_engine + ", " + percent(e.busiest_share) +
                      " of the time");
  }
  const std::string drops = drops_line(evaluator, figures);
  if (!drops.empty()) e.lines.push_back(drops);
  // A price does not depend on speed: what speed buys then is latency.
  const Objective gained = objective == Objective::cost ? Objective::latency : objective;
  e.sensitivities = sensitivities(evaluator, placement, score, gained);
  e.lines.push_back(help_line(e.sensitivities, gained));
  return e;
}

}  // namespace partita::partition
