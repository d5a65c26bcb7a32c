#include "partition/simulate/compile.h"

#include <algorithm>
#include <cmath>

namespace partita::partition {
namespace {

using profile::DeviceType;
using timeline::Demand;
using timeline::EngineKind;
using timeline::Placement;

double factor(const std::vector<double>& speeds, std::size_t index) {
  return index < speeds.size() ? speeds[index] : 1.0;
}

Ns faster(Ns duration, double speed) {
  return speed == 1.0 ? duration
                      : static_cast<Ns>(std::llround(static_cast<double>(duration) / speed));
}

Demand faster(Demand demand, double speed) {
  demand.launch_ns = faster(demand.launch_ns, speed);
  demand.compute_ns = faster(demand.compute_ns, speed);
  demand.memory_ns = faster(demand.memory_ns, speed);
  return demand;
}

std::uint64_t faster_bps(std::uint64_t bps, double speed) {
  return std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::llround(static_cast<double>(bps) * speed)));
}

OpType type_of(StepKind kind) {
  switch (kind) {
    case StepKind::write:
      return OpType::write;
    case StepKind::read:
      return OpType::read;
    case StepKind::kernel:
      return OpType::kernel;
    case StepKind::copy:
      return OpType::copy;
    case StepKind::host:
      return OpType::host;
    case StepKind::finish:
      break;
  }
  return OpType::finish;
}

/// A layout whose memories and links are as fast as asked. A memory that is shared is as fast as
/// its fastest user needs: a device twice as fast draws twice the bandwidth.
timeline::Layout scaled_layout(const profile::Machine& machine, const Speeds& speeds) {
  timeline::Layout layout = timeline::make_layout(machine);
  for (std::size_t n = 0; n < layout.nodes.size(); ++n) {
    const double speed = factor(speeds.nodes, n);
    layout.nodes[n].memory_bps = faster_bps(layout.nodes[n].memory_bps, speed);
    layout.nodes[n].unit_memory_bps = layout.nodes[n].unit_memory_bps == 0
                                          ? 0
                                          : faster_bps(layout.nodes[n].unit_memory_bps, speed);
  }
  for (std::size_t d = 0; d < layout.devices.size(); ++d) {
    timeline::LayoutDevice& device = layout.devices[d];
    device.memory_bps = faster_bps(device.memory_bps, factor(speeds.devices, d));
    device.link_bps = faster_bps(device.link_bps, factor(speeds.buses, d));
    device.link_latency_ns = faster(device.link_latency_ns, factor(speeds.buses, d));
    if (device.shared_memory) {
      timeline::LayoutNode& node = layout.nodes[device.node];
      node.memory_bps = std::max(node.memory_bps, device.memory_bps);
    }
  }
  for (std::size_t l = 0; l < layout.links.size(); ++l) {
    layout.links[l].bps = faster_bps(layout.links[l].bps, factor(speeds.links, l));
    layout.links[l].latency_ns = faster(layout.links[l].latency_ns, factor(speeds.links, l));
  }
  timeline::check_layout(layout);
  return layout;
}

FreeFrame run_free(const CompiledTask& task, const CompiledFrame& frame) {
  FreeFrame free;
  Ns clock = 0, queue_end = 0;
  const auto block = [&](Ns end) {
    clock += task.api_ns;
    if (end > clock) clock = end + task.wakeup_ns;
  };
  for (const Op& op : frame.ops) {
    if (op.type == OpType::finish) {
      block(queue_end);
      continue;
    }
    if (op.type == OpType::host) {
      clock += op.alone;
      free.host += op.alone;
      continue;
    }
    Ns& engine = op.type == OpType::write  ? free.to_device
                 : op.type == OpType::read ? free.from_device
                                           : free.compute;
    engine += op.alone;
    clock += task.api_ns;
    queue_end = std::max(clock + task.submit_ns, queue_end) + op.alone;
    if (op.blocking) block(queue_end);
  }
  free.duration = clock;
  free.queue_end = queue_end;
  return free;
}

}  // namespace

Compiler::Compiler(const profile::Machine& machine, const Speeds& speeds)
    : machine_(machine),
      speeds_(speeds),
      layout_(scaled_layout(machine, speeds)),
      placement_(layout_, nullptr) {
  for (const auto& device : machine.devices) device_models_.emplace_back(device.profile);
  for (std::size_t n = 0; n < machine.nodes.size(); ++n) {
    node_models_.emplace_back(machine.nodes[n].host);
    slot(machine.nodes[n].name + "/cores", EngineKind::core, static_cast<std::uint32_t>(n), kNone);
  }
}

/// A CPU that is also its node's host is one thing: what makes the one faster does the other.
double Compiler::device_speed(std::uint32_t device) const {
  const auto& d = machine_.devices[device];
  return d.is_host_cpu ? factor(speeds_.nodes, d.node) : factor(speeds_.devices, device);
}

std::uint32_t Compiler::name(const std::string& text) {
  const auto known = std::find(names_.begin(), names_.end(), text);
  if (known != names_.end()) return static_cast<std::uint32_t>(known - names_.begin());
  names_.push_back(text);
  return static_cast<std::uint32_t>(names_.size() - 1);
}

std::uint32_t Compiler::slot(std::string name, EngineKind kind, std::uint32_t node,
                             std::uint32_t device) {
  const auto known =
      std::find_if(slots_.begin(), slots_.end(), [&](const Slot& s) { return s.name == name; });
  if (known != slots_.end()) return static_cast<std::uint32_t>(known - slots_.begin());
  slots_.push_back({std::move(name), kind, node, device});
  return static_cast<std::uint32_t>(slots_.size() - 1);
}

std::uint32_t Compiler::memory_of(std::uint32_t device) const {
  const timeline::LayoutDevice& d = layout_.devices[device];
  if (d.shared_memory || d.is_host_cpu) return d.node;
  if (d.type != DeviceType::fpga) return kNone;
  return static_cast<std::uint32_t>(layout_.nodes.size()) + device;
}

std::uint32_t Compiler::link_between(std::uint32_t a, std::uint32_t b) const {
  const auto found = std::find_if(
      layout_.links.begin(), layout_.links.end(), [&](const timeline::LayoutLink& link) {
        return (link.a == a && link.b == b) || (link.a == b && link.b == a);
      });
  return static_cast<std::uint32_t>(found - layout_.links.begin());  // check_layout: there is one
}

timeline::Prepared Compiler::prepare(const TaskWork& task, const Step& step, const CompiledTask& at,
                                     OpDetail& detail) const {
  switch (step.kind) {
    case StepKind::host:
      detail.work = &task.works[step.work][0];
      return placement_.prepare_step(
          at.node, faster(timeline::demand_of(node_models_[at.node].host_step(*detail.work)),
                          factor(speeds_.nodes, at.node)));
    case StepKind::kernel: {
      const profile::DeviceProfile& profile = machine_.devices[at.device].profile;
      detail.work = &task.works[step.work][variant_index(profile.type)];
      detail.launch = {std::max<std::uint64_t>(detail.work->groups, 1),
                       std::max<std::uint64_t>(detail.work->group_items, 1),
                       detail.work->group_local_bytes};
      model::Circuit circuit;
      if (profile.type == DeviceType::fpga) {
        circuit = step.circuit;
        detail.compute_units = std::clamp(circuit.compute_units, 1u, 64u);
      }
      return placement_.prepare(at.device,
                                faster(timeline::demand_of(device_models_[at.device].kernel(
                                           *detail.work, detail.launch, circuit)),
                                       device_speed(at.device)));
    }
    case StepKind::copy:
      return placement_.prepare_inside(
          at.device, faster(timeline::demand_of(device_models_[at.device].copy(step.bytes)),
                            device_speed(at.device)));
    case StepKind::write:
    case StepKind::read:
      detail.bytes = step.bytes;
      return placement_.prepare_transfer(at.device, step.bytes);
    case StepKind::finish:
      break;
  }
  return {};
}

Op Compiler::op(const Step& step, const CompiledTask& at) {
  Op op;
  op.type = type_of(step.kind);
  op.blocking = step.blocking;
  op.slot = at.node;  // its cores
  if (op.type == OpType::finish || op.type == OpType::host) return op;
  const timeline::LayoutDevice& d = layout_.devices[at.device];
  const std::string& node = layout_.nodes[d.node].name;
  if (op.type == OpType::write || op.type == OpType::read) {
    op.slot = slot(op.type == OpType::write ? node + ">" + d.name : d.name + ">" + node,
                   EngineKind::link, d.node, at.device);
  } else if (d.type == DeviceType::gpu) {
    op.slot = slot(d.name, EngineKind::compute, d.node, at.device);
  } else if (d.type == DeviceType::fpga) {
    const bool kernel = op.type == OpType::kernel;
    op.own_engine = kernel && at.details.back().compute_units == 1;
    op.slot =
        slot(d.name + "/" + (kernel ? step.name : "copy"), EngineKind::compute, d.node, at.device);
  }
  return op;
}

void Compiler::add_step(const TaskWork& task, const Step& step, CompiledTask& at,
                        CompiledFrame& frame) {
  at.details.emplace_back();
  at.details.back().name = name(step.name);
  at.prepared.push_back(prepare(task, step, at, at.details.back()));
  const timeline::Prepared& prepared = at.prepared.back();
  frame.ops.push_back(op(step, at));
  Op& added = frame.ops.back();
  added.detail = static_cast<std::uint32_t>(at.details.size() - 1);
  added.alone = prepared.alone();
  const bool host = added.type == OpType::host;
  const bool transfer = added.type == OpType::write || added.type == OpType::read;
  (host ? frame.node_bytes : frame.device_bytes) += transfer ? step.bytes : prepared.demand.bytes;
  std::uint32_t& most = host ? at.host_share : at.device_share;
  most = std::max(most, prepared.share);
}

/// Bursts and free runs.
void Compiler::find_runs(const CompiledTask& at, CompiledFrame& frame) const {
  if (at.device == kNone) return;
  const timeline::LayoutDevice& d = layout_.devices[at.device];
  const auto enqueued = [&](std::size_t i) {
    return i < frame.ops.size() && !frame.ops[i].blocking && frame.ops[i].type != OpType::host &&
           frame.ops[i].type != OpType::finish;
  };
  const auto on_compute = [&](std::size_t i) {
    if (!enqueued(i) || d.type == DeviceType::fpga) return false;
    const Op& op = frame.ops[i];
    if (op.type != OpType::kernel && op.type != OpType::copy) return false;
    return d.type == DeviceType::gpu || at.prepared[op.detail].cores == layout_.nodes[d.node].cores;
  };
  for (std::size_t first = 0; first < frame.ops.size(); ++first) {
    Ns busy = 0, host = 0;
    std::uint32_t count = 0;
    for (std::size_t i = first; on_compute(i) && host <= busy; ++i, ++count) {
      busy += frame.ops[i].alone;
      host += at.api_ns;
    }
    frame.ops[first].burst = count;
  }
  for (std::size_t first = 0; first < frame.ops.size(); ++first) {
    FreeRun run;
    for (std::size_t i = first; enqueued(i); ++i, ++run.ops) {
      run.host += at.api_ns;
      run.after_queue += frame.ops[i].alone;
      run.after_host = std::max(run.after_host + frame.ops[i].alone,
                                run.host + at.submit_ns + frame.ops[i].alone);
    }
    if (run.ops == 0) continue;
    frame.ops[first].free_run = static_cast<std::uint32_t>(frame.free_runs.size());
    frame.free_runs.push_back(run);
    first += run.ops - 1;
  }
}

CompiledTask Compiler::compile(const TaskWork& task, const Place& place) {
  CompiledTask compiled;
  if (place.is_device) {
    const timeline::LayoutDevice& d = layout_.devices[place.index];
    compiled.device = place.index;
    compiled.node = d.node;
    compiled.api_ns = d.api_call_ns;
    compiled.submit_ns = d.submit_ns;
    compiled.wakeup_ns = d.wakeup_ns;
  } else {
    compiled.node = place.index;
  }
  for (const Program& program : task.frames) {
    CompiledFrame frame;
    std::vector<Ns> held;
    for (const Step& step : program) {
      if (!place.is_device && step.kind != StepKind::host) continue;
      add_step(task, step, compiled, frame);
      const Op& op = frame.ops.back();
      held.resize(slots_.size(), 0);
      if (op.type != OpType::host) held[op.slot] += op.alone;
    }
    for (std::uint32_t s = 0; s < held.size(); ++s) {
      if (held[s] > 0) frame.held.emplace_back(s, held[s]);
    }
    find_runs(compiled, frame);
    frame.free = run_free(compiled, frame);
    compiled.frames.push_back(std::move(frame));
  }
  return compiled;
}

}  // namespace partita::partition
