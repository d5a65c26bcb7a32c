#include "partition/simulate/figures.h"

#include <algorithm>

namespace partita::partition {
namespace {

using profile::DeviceType;

Ns trigger(const Scene& scene, std::size_t frame) {
  return frame * scene.pipeline->period_ns;
}

Distribution latencies(const Trace& trace, const Scene& scene,
                       const std::vector<std::uint32_t>& tasks) {
  std::vector<Ns> values;
  values.reserve(scene.frames);
  for (std::size_t k = 0; k < scene.frames; ++k) {
    const Ns end = last_end(trace, tasks, k);
    if (end != Trace::kNot) values.push_back(end - trigger(scene, k));
  }
  return distribution(std::move(values));
}

/// Per task and frame: trigger of the oldest frame that went into what it posted.
std::vector<std::vector<Ns>> oldest_data(const Trace& trace, const Scene& scene) {
  const auto& tasks = scene.pipeline->tasks;
  std::vector<std::vector<Ns>> oldest(tasks.size(), std::vector<Ns>(scene.frames, Trace::kNot));
  for (std::size_t i = 0; i < tasks.size(); ++i) {  // in topological order
    std::vector<Ns> latest(tasks[i].inputs.size(), Trace::kNot);
    for (std::size_t k = 0; k < scene.frames; ++k) {
      Ns since = trigger(scene, k);
      for (std::size_t j = 0; j < latest.size(); ++j) {
        const Ns posted = oldest[tasks[i].inputs[j].task][k];
        if (posted != Trace::kNot) latest[j] = posted;
        if (latest[j] != Trace::kNot) since = std::min(since, latest[j]);
      }
      if (trace.tasks[i].end[k] != Trace::kNot) oldest[i][k] = since;
    }
  }
  return oldest;
}

Distribution ages(const Trace& trace, const Scene& scene) {
  const auto oldest = oldest_data(trace, scene);
  std::vector<Ns> values;
  for (const std::uint32_t task : scene.pipeline->outputs) {
    for (std::size_t k = 0; k < scene.frames; ++k) {
      if (oldest[task][k] == Trace::kNot) continue;
      values.push_back(trace.tasks[task].end[k] - oldest[task][k]);
    }
  }
  return distribution(std::move(values));
}

Ns deadline(const Scene& scene, std::uint32_t task) {
  const std::uint64_t own = scene.pipeline->tasks[task].deadline_ns;
  return own > 0 ? own : scene.pipeline->period_ns;
}

/// Frames per second that all tasks of the list finished, from the first to the last.
double rate(const Trace& trace, const Scene& scene, const std::vector<std::uint32_t>& tasks) {
  std::size_t count = 0;
  Ns first = 0, last = 0;
  for (std::size_t k = 0; k < scene.frames; ++k) {
    const Ns end = last_end(trace, tasks, k);
    if (end == Trace::kNot) continue;
    if (count++ == 0) first = end;
    last = std::max(last, end);
  }
  return rate_of(count, first, last);
}

}  // namespace

Ns last_end(const Trace& trace, const std::vector<std::uint32_t>& tasks, std::size_t frame) {
  Ns last = 0;
  for (const std::uint32_t task : tasks) {
    if (trace.tasks[task].end[frame] == Trace::kNot) return Trace::kNot;
    last = std::max(last, trace.tasks[task].end[frame]);
  }
  return last;
}

double rate_of(std::size_t count, Ns first, Ns last) {
  if (count < 2) return 0;
  return static_cast<double>(count - 1) * 1e9 / static_cast<double>(std::max<Ns>(last - first, 1));
}

Parts parts_of(const Scene& scene, const profile::Machine& machine) {
  Parts parts;
  parts.devices.assign(machine.devices.size(), false);
  parts.nodes.assign(machine.nodes.size(), false);
  parts.nodes[machine.sensor_node] = true;
  for (const CompiledTask* task : scene.tasks) {
    parts.nodes[task->node] = true;
    if (task->device != kNone) parts.devices[task->device] = true;
  }
  return parts;
}

double price_of(const Parts& parts, const profile::Machine& machine) {
  double price = 0;
  for (std::size_t d = 0; d < machine.devices.size(); ++d) {
    const profile::MachineDevice& device = machine.devices[d];
    if (parts.devices[d] && !device.is_host_cpu) price += device.profile.price_usd;
  }
  for (std::size_t n = 0; n < machine.nodes.size(); ++n) {
    if (parts.nodes[n]) price += machine.nodes[n].host.price_usd;
  }
  return price;
}

void add(std::vector<std::uint64_t>& sum, const std::vector<std::uint64_t>& more,
         std::size_t times) {
  sum.resize(std::max(sum.size(), more.size()), 0);
  for (std::size_t i = 0; i < more.size(); ++i) sum[i] += times * more[i];
}

void add(Consumption& sum, const Consumption& more, std::size_t times) {
  add(sum.device_busy, more.device_busy, times);
  add(sum.node_busy, more.node_busy, times);
  add(sum.device_bytes, more.device_bytes, times);
  add(sum.node_bytes, more.node_bytes, times);
  add(sum.link_bytes, more.link_bytes, times);
}

Consumption difference(Consumption whole, const Consumption& part) {
  add(whole, part, std::size_t{0} - 1);  // unsigned: times -1
  return whole;
}

double joules(const Consumption& c, const Parts& parts, const profile::Machine& machine) {
  const double length = static_cast<double>(c.makespan) * 1e-9;
  double sum = 0;
  for (std::size_t d = 0; d < machine.devices.size(); ++d) {
    const profile::MachineDevice& device = machine.devices[d];
    const profile::Power& power = device.profile.power;
    sum += power.transfer_j_per_byte * static_cast<double>(c.device_bytes[d]);
    if (device.is_host_cpu || !parts.devices[d]) continue;
    const double share = device.profile.type == DeviceType::fpga ? timeline::kFpgaShare : 1.0;
    sum += power.idle_w * length +
           (power.busy_w - power.idle_w) * share * static_cast<double>(c.device_busy[d]) * 1e-9;
  }
  for (std::size_t n = 0; n < machine.nodes.size(); ++n) {
    const profile::DeviceProfile& host = machine.nodes[n].host;
    if (parts.nodes[n]) sum += host.power.idle_w * length;
    sum += (host.power.busy_w - host.power.idle_w) / host.performance.units *
           static_cast<double>(c.node_busy[n]) * 1e-9;
    sum += host.power.transfer_j_per_byte * static_cast<double>(c.node_bytes[n]);
  }
  for (std::size_t l = 0; l < machine.links.size(); ++l) {
    sum += machine.links[l].transfer_j_per_byte * static_cast<double>(c.link_bytes[l]);
  }
  return sum;
}

void EngineUses::add(const std::string& engine, timeline::EngineKind kind, std::uint32_t node,
                     Ns busy) {
  if (busy == 0) return;
  const bool core = kind == timeline::EngineKind::core;
  const std::string name = core ? machine_.nodes[node].name + "/cores" : engine;
  auto known = std::find_if(uses_.begin(), uses_.end(),
                            [&](const EngineUse& use) { return use.name == name; });
  if (known == uses_.end()) {
    known = uses_.insert(known, {name, 0, 0});
    engines_.push_back(core ? machine_.nodes[node].host.performance.units : 1.0);
  }
  known->busy += busy;
}

std::vector<EngineUse> EngineUses::by_share(Ns makespan) const {
  std::vector<EngineUse> uses = uses_;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    uses[i].share =
        static_cast<double>(uses[i].busy) / (static_cast<double>(makespan) * engines_[i]);
  }
  std::sort(uses.begin(), uses.end(), [](const EngineUse& a, const EngineUse& b) {
    return a.share != b.share ? a.share > b.share : a.name < b.name;
  });
  return uses;
}

Figures figures_of(const Trace& trace, const Scene& scene) {
  Figures figures;
  figures.latency = latencies(trace, scene, scene.pipeline->outputs);
  figures.perception = latencies(trace, scene, scene.pipeline->perception);
  figures.throughput_hz = rate(trace, scene, scene.pipeline->outputs);
  count_frames(trace, scene, figures);
  return figures;
}

void count_frames(const Trace& trace, const Scene& scene, Figures& figures) {
  for (std::size_t k = 0; k < scene.frames; ++k) {
    bool late = false, dropped = false;
    for (const std::uint32_t task : scene.pipeline->outputs) {
      if (!scene.runs(task, k)) continue;
      const Ns end = trace.tasks[task].end[k];
      dropped = dropped || end == Trace::kNot;
      late = late || (end != Trace::kNot && end - trigger(scene, k) > deadline(scene, task));
    }
    figures.late += late ? 1 : 0;
    figures.dropped += dropped ? 1 : 0;
  }
  for (const Trace::Task& task : trace.tasks) figures.dropped_by_tasks += task.dropped;
}

void add_details(const Trace& trace, const Scene& scene, Figures& figures) {
  figures.age = ages(trace, scene);
  for (std::uint32_t i = 0; i < trace.tasks.size(); ++i) {
    const Trace::Task& task = trace.tasks[i];
    TaskFigures own;
    std::vector<Ns> latency, duration;
    for (std::size_t k = 0; k < scene.frames; ++k) {
      if (task.end[k] == Trace::kNot) continue;
      latency.push_back(task.end[k] - trigger(scene, k));
      duration.push_back(task.end[k] - task.start[k]);
      own.late += latency.back() > deadline(scene, i) ? 1 : 0;
    }
    own.latency = distribution(std::move(latency));
    own.duration = distribution(std::move(duration));
    own.dropped = task.dropped;
    figures.tasks.push_back(own);
  }
}

void set_energy(Figures& figures, const Scene& scene, double joules, Ns makespan) {
  const std::size_t done = scene.frames - figures.dropped;
  figures.makespan = makespan;
  figures.energy_per_frame_j = done > 0 ? joules / static_cast<double>(done) : 0;
  figures.power_w = makespan > 0 ? joules * 1e9 / static_cast<double>(makespan) : 0;
}

}  // namespace partita::partition
