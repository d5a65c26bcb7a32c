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
  // Whole nanoseconds and bytes are summed first: the sums of fractions would depend on the order
  // in which racing threads happened to be recorded.
  std::vector<Ns> busy(schedule.engines.size(), 0);
  std::vector<std::uint64_t> link_bytes(machine.links.size(), 0);
  std::vector<std::uint64_t> device_bytes(machine.devices.size(), 0);
  std::vector<std::uint64_t> node_bytes(machine.nodes.size(), 0);
  for (const Occupation& o : schedule.occupations) {
    if (record.commands[o.node].kind == CommandKind::load) continue;  // nothing works meanwhile
    busy[o.engine] += o.end - o.start;
    const std::uint32_t network = schedule.engines[o.engine].network;
    if (network != kNone) link_bytes[network] += record.commands[o.node].bytes;
  }
  for (const ScheduledCommand& s : schedule.commands) {
    const RecordedCommand& c = record.commands[s.command];
    if (!s.resolved || s.status < 0 || s.engine == kNone) continue;
    if (c.queue != kNone) {
      device_bytes[record.queues[c.queue].device] += moved_bytes(c);
    } else if (c.kind == CommandKind::host_step) {
      node_bytes[record.threads[c.thread].node] += moved_bytes(c);
    }
  }
  for (std::size_t i = 0; i < busy.size(); ++i) {
    const Engine& engine = schedule.engines[i];
    const double seconds = static_cast<double>(busy[i]) / kSecond;
    if (engine.kind == EngineKind::core) {
      const auto& host = machine.nodes[engine.node].host;
      const double watts = (host.power.busy_w - host.power.idle_w) / host.performance.units;
      energy.items[node_item[engine.node]].busy_j += watts * seconds;
    } else if (engine.kind == EngineKind::compute) {
      const auto& device = machine.devices[engine.device].profile;
      energy.items[device_item[engine.device]].busy_j +=
          dynamic_watts(device, fpga_share) * seconds;
    }
  }
  for (std::size_t i = 0; i < link_bytes.size(); ++i) {
    energy.items[link_item[i]].transfer_j +=
        machine.links[i].transfer_j_per_byte * static_cast<double>(link_bytes[i]);
  }
  for (std::size_t i = 0; i < device_bytes.size(); ++i) {
    energy.items[device_item[i]].transfer_j +=
        machine.devices[i].profile.power.transfer_j_per_byte * static_cast<double>(device_bytes[i]);
  }
  for (std::size_t i = 0; i < node_bytes.size(); ++i) {
    energy.items[node_item[i]].transfer_j +=
        machine.nodes[i].host.power.transfer_j_per_byte * static_cast<double>(node_bytes[i]);
  }
  return energy;
}

}  // namespace partita::timeline
