#include "partition/compile.h"

#include <algorithm>
#include <cmath>

namespace partita::partition {
namespace {

using timeline::Demand;
using timeline::EngineKind;
using timeline::Placement;
using profile::DeviceType;

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
    layout.nodes[n].unit_memory_bps =
        layout.nodes[n].unit_memory_bps == 0
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
  return layout;
}

}  // namespace

Compiler::Compiler(const profile::Machine& machine, const Speeds& speeds)
    : machine_(machine), speeds_(speeds), layout_(scaled_layout(machine, speeds)) {
  timeline::check_layout(layout_);
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
  const auto known = std::find_if(slots_.begin(), slots_.end(),
                                  [&](const Slot& s) { return s.name == name; });
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

/// Between host and device, and the traffic that it makes in a memory that both share.
Ns Compiler::transfer_ns(std::uint32_t device, std::uint64_t bytes, std::uint64_t& traffic) const {
  const timeline::LayoutDevice& d = layout_.devices[device];
  traffic = d.shared_memory ? 2 * bytes : 0;
  return bytes == 0 ? 0 : Placement::duration_of(bytes, d.link_bps);
}

OpDetail Compiler::detail(const TaskWork& task, const Step& step, const CompiledTask& at) {
  OpDetail detail;
  detail.name = name(step.name);
  if (step.kind == StepKind::host) {
    detail.work = &task.works[step.work][0];
    detail.demand = faster(timeline::demand_of(node_models_[at.node].host_step(*detail.work)),
                           factor(speeds_.nodes, at.node));
  } else if (step.kind == StepKind::kernel) {
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
    detail.demand = faster(timeline::demand_of(device_models_[at.device].kernel(
                               *detail.work, detail.launch, circuit)),
                           device_speed(at.device));
  } else if (step.kind == StepKind::copy) {
    detail.demand = faster(timeline::demand_of(device_models_[at.device].copy(step.bytes)),
                           device_speed(at.device));
  } else if (step.kind != StepKind::finish) {
    detail.bytes = step.bytes;
  }
  return detail;
}

Op Compiler::op(const Step& step, const OpDetail& detail, const CompiledTask& at) {
  Op op;
  op.type = type_of(step.kind);
  op.blocking = step.blocking;
  if (op.type == OpType::finish) return op;
  const Ns busy = std::max(detail.demand.compute_ns, detail.demand.memory_ns);
  if (op.type == OpType::host) {
    op.alone = detail.demand.launch_ns + busy;
    op.share = Placement::share_of(layout_.nodes[at.node].memory_bps, busy, detail.demand.bytes);
    op.slot = at.node;
    return op;
  }
  const timeline::LayoutDevice& d = layout_.devices[at.device];
  const std::string& node = layout_.nodes[d.node].name;
  const std::uint32_t memory = memory_of(at.device);
  const std::uint64_t bps = memory < layout_.nodes.size() ? layout_.nodes[memory].memory_bps
                                                          : d.memory_bps;
  if (op.type == OpType::write || op.type == OpType::read) {
    std::uint64_t traffic = 0;
    const Ns moving = transfer_ns(at.device, detail.bytes, traffic);
    op.alone = detail.bytes == 0 ? 0 : d.link_latency_ns + moving;
    op.share = memory == kNone ? 0 : Placement::share_of(bps, moving, traffic);
    op.slot = slot(op.type == OpType::write ? node + ">" + d.name : d.name + ">" + node,
                   EngineKind::link, d.node, at.device);
    return op;
  }
  op.alone = detail.demand.launch_ns + busy;
  op.share = memory == kNone ? 0 : Placement::share_of(bps, busy, detail.demand.bytes);
  if (d.type == DeviceType::cpu) {
    op.slot = at.node;
  } else if (d.type == DeviceType::gpu) {
    op.slot = slot(d.name, EngineKind::compute, d.node, at.device);
  } else {
    op.own_engine = op.type == OpType::kernel && detail.compute_units == 1;
    op.slot = slot(d.name + "/" + (op.type == OpType::copy ? "copy" : step.name),
                   EngineKind::compute, d.node, at.device);
  }
  return op;
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
    for (const Step& step : program) {
      if (!place.is_device && step.kind != StepKind::host) continue;
      compiled.details.push_back(detail(task, step, compiled));
      const OpDetail& d = compiled.details.back();
      frame.ops.push_back(op(step, d, compiled));
      Op& last = frame.ops.back();
      last.detail = static_cast<std::uint32_t>(compiled.details.size() - 1);
      const bool host = last.type == OpType::host;
      (host ? frame.node_bytes : frame.device_bytes) += d.bytes + d.demand.bytes;
      std::uint32_t& most = host ? compiled.host_share : compiled.device_share;
      most = std::max(most, last.share);
    }
    compiled.frames.push_back(std::move(frame));
  }
  return compiled;
}

}  // namespace partita::partition
