#include "devices/timeline/layout.h"

#include <cmath>

namespace partita::timeline {
namespace {

std::uint64_t whole(double value) {
  return static_cast<std::uint64_t>(std::llround(value));
}

void require(bool holds, const std::string& what) {
  if (!holds) throw profile::Error("timeline: layout: " + what);
}

constexpr std::uint64_t kMostBps = 1000000000000000;  // 1 PB/s
constexpr Ns kMostCost = 100000000000;                // 100 s

bool bandwidth(std::uint64_t bps) {
  return bps > 0 && bps <= kMostBps;
}

}  // namespace

void check_layout(const Layout& layout) {
  const std::size_t nodes = layout.nodes.size();
  require(nodes >= 1 && nodes <= 64, "expected 1 to 64 nodes");
  require(layout.devices.size() <= 256, "expected at most 256 devices");
  require(layout.main_node < nodes && layout.sensor_node < nodes, "main or sensor node missing");
  for (const auto& n : layout.nodes) {
    require(n.cores >= 1 && n.cores <= 4096, "node '" + n.name + "': expected 1 to 4096 cores");
    require(bandwidth(n.memory_bps) && n.unit_memory_bps <= kMostBps,
            "node '" + n.name + "': memory bandwidth out of range");
    require(n.api_call_ns <= kMostCost && n.wakeup_ns <= kMostCost,
            "node '" + n.name + "': costs above 100 s");
  }
  for (const auto& d : layout.devices) {
    require(d.node < nodes, "device '" + d.name + "': its node does not exist");
    require(bandwidth(d.memory_bps) && bandwidth(d.link_bps),
            "device '" + d.name + "': bandwidth out of range");
    require(d.type <= profile::DeviceType::fpga &&
                (d.type == profile::DeviceType::cpu) == d.is_host_cpu,
            "device '" + d.name + "': expected a cpu to be its node's host");
    require(d.api_call_ns <= kMostCost && d.submit_ns <= kMostCost && d.wakeup_ns <= kMostCost &&
                d.link_latency_ns <= kMostCost,
            "device '" + d.name + "': costs above 100 s");
  }
  std::size_t joined = 0;
  for (const auto& l : layout.links) {
    require(l.a < nodes && l.b < nodes && l.a != l.b, "link '" + l.name + "': joins no two nodes");
    require(bandwidth(l.bps) && l.latency_ns <= kMostCost, "link '" + l.name + "': out of range");
  }
  for (std::uint32_t a = 0; a < nodes; ++a) {
    for (std::uint32_t b = a + 1; b < nodes; ++b) {
      for (const auto& l : layout.links) {
        joined += (l.a == a && l.b == b) || (l.a == b && l.b == a) ? 1 : 0;
      }
    }
  }
  require(layout.links.size() == nodes * (nodes - 1) / 2 && joined == layout.links.size(),
          "expected one link between every two nodes");
}

Layout make_layout(const profile::Machine& machine) {
  Layout layout;
  layout.machine = machine.id;
  layout.machine_hash = machine.content_hash;
  layout.main_node = machine.main_node;
  layout.sensor_node = machine.sensor_node;
  for (const auto& node : machine.nodes) {
    const auto& p = node.host.performance;
    layout.nodes.push_back({node.name, p.units, whole(p.memory_bandwidth * p.memory_reachable),
                            whole(p.unit_memory_bandwidth), node.host.host.api_call_ns,
                            node.host.host.wakeup_ns});
  }
  for (const auto& device : machine.devices) {
    const auto& profile = device.profile;
    const auto& p = profile.performance;
    layout.devices.push_back(
        {device.name, profile.type, device.node, device.is_host_cpu, profile.link.shared_memory,
         whole(p.memory_bandwidth * p.memory_reachable), whole(profile.link.bandwidth),
         profile.link.latency_ns, profile.host.api_call_ns, profile.host.submit_ns,
         profile.host.wakeup_ns});
  }
  for (const auto& link : machine.links) {
    layout.links.push_back({link.name, link.a, link.b, whole(link.bandwidth), link.latency_ns});
  }
  return layout;
}

}  // namespace partita::timeline
