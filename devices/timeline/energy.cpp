// Energy of a schedule: idle power over its whole length, the power above idle while engines are
// busy, and what moving bytes costs.
#include "devices/timeline/schedule.h"

namespace partita::timeline {
namespace {

constexpr double kSecond = 1e9;

/// Watts above idle that one engine of a device draws while busy.
double dynamic_watts(const profile::DeviceProfile& device, double fpga_share) {
  const double dynamic = device.power.busy_w - device.power.idle_w;
  return device.type == profile::DeviceType::fpga ? dynamic * fpga_share : dynamic;
}

std::uint64_t moved_bytes(const RecordedCommand& c) {
  return c.bytes + c.demand.bytes;
}

}  // namespace

double Energy::total() const {
  double sum = 0;
  for (const EnergyItem& item : items) sum += item.total();
  return sum;
}

Energy energy(const Schedule& schedule, const Record& record, const profile::Machine& machine,
              double fpga_share) {
  if (machine.devices.size() != record.layout.devices.size() ||
      machine.nodes.size() != record.layout.nodes.size() ||
      machine.links.size() != record.layout.links.size()) {
    throw profile::Error("energy: machine '" + machine.id + "' is not the record's '" +
                         record.layout.machine + "'");
  }
  const double length = static_cast<double>(schedule.makespan) / kSecond;
  Energy energy;
  // Items: devices that are not a node's own CPU, then the nodes' CPUs, then the links.
  std::vector<std::size_t> device_item, node_item, link_item;
  for (const auto& device : machine.devices) {
    device_item.push_back(energy.items.size());
    if (!device.is_host_cpu) {
      energy.items.push_back({device.name, device.profile.power.idle_w * length, 0, 0});
    }
  }
  for (const auto& node : machine.nodes) {
    node_item.push_back(energy.items.size());
    energy.items.push_back({node.name + "/" + node.host.id, node.host.power.idle_w * length, 0, 0});
  }
  for (const auto& link : machine.links) {
    link_item.push_back(energy.items.size());
    energy.items.push_back({link.name, 0, 0, 0});
  }
  for (std::size_t d = 0; d < machine.devices.size(); ++d) {
    if (machine.devices[d].is_host_cpu) device_item[d] = node_item[machine.devices[d].node];
  }
  for (const Occupation& o : schedule.occupations) {
    const Engine& engine = schedule.engines[o.engine];
    const double busy = static_cast<double>(o.end - o.start) / kSecond;
    if (engine.kind == EngineKind::core) {
      const auto& host = machine.nodes[engine.node].host;
      const double watts = (host.power.busy_w - host.power.idle_w) / host.performance.units;
      energy.items[node_item[engine.node]].busy_j += watts * busy;
    } else if (engine.kind == EngineKind::compute) {
      const auto& device = machine.devices[engine.device].profile;
      energy.items[device_item[engine.device]].busy_j += dynamic_watts(device, fpga_share) * busy;
    } else if (engine.network != kNone) {
      energy.items[link_item[engine.network]].transfer_j +=
          machine.links[engine.network].transfer_j_per_byte *
          static_cast<double>(record.commands[o.node].bytes);
    }
  }
  for (const ScheduledCommand& s : schedule.commands) {
    const RecordedCommand& c = record.commands[s.command];
    if (!s.resolved || s.status < 0 || s.engine == kNone) continue;
    if (c.queue != kNone) {
      const auto device = record.queues[c.queue].device;
      energy.items[device_item[device]].transfer_j +=
          machine.devices[device].profile.power.transfer_j_per_byte *
          static_cast<double>(moved_bytes(c));
    } else if (c.kind == CommandKind::host_step) {
      const auto node = record.threads[c.thread].node;
      energy.items[node_item[node]].transfer_j +=
          machine.nodes[node].host.power.transfer_j_per_byte * static_cast<double>(moved_bytes(c));
    }
  }
  return energy;
}

}  // namespace partita::timeline
