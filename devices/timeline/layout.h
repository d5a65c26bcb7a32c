// Layout: what the predicted clock needs to know of a machine, as plain integers. Every engine,
// cost and bandwidth of a timeline follows from it, and it is part of a record, so that a record
// replays without its profiles.
#ifndef PARTITA_DEVICES_TIMELINE_LAYOUT_H
#define PARTITA_DEVICES_TIMELINE_LAYOUT_H

#include <cstdint>
#include <string>
#include <vector>

#include "devices/model/model.h"
#include "devices/profile/machine.h"

namespace partita::timeline {

/// Virtual nanoseconds since the machine's start.
using Ns = std::uint64_t;
inline constexpr Ns kLongest = Ns{1}
                               << 42;       ///< of one command: 73 minutes; more is a slip of units
inline constexpr Ns kLatest = Ns{1} << 60;  ///< of any time: 36 years

struct LayoutNode {
  std::string name;
  std::uint32_t cores = 1;
  std::uint64_t memory_bps = 0;       ///< B/s that all clients of the node's memory can reach
  std::uint64_t unit_memory_bps = 0;  ///< B/s that one core can draw; 0: no such limit
  std::uint64_t api_call_ns = 0;      ///< of host calls that concern no device
  std::uint64_t wakeup_ns = 0;
  bool operator==(const LayoutNode&) const = default;
};

struct LayoutDevice {
  std::string name;
  profile::DeviceType type = profile::DeviceType::cpu;
  std::uint32_t node = 0;
  bool is_host_cpu = false;      ///< its kernels run on the node's cores
  bool shared_memory = false;    ///< draws from the node's memory, not from its own
  std::uint64_t memory_bps = 0;  ///< B/s reachable in its own memory (or the node's)
  std::uint64_t link_bps = 0;    ///< B/s per direction between host and device
  std::uint64_t link_latency_ns = 0;
  std::uint64_t api_call_ns = 0, submit_ns = 0, wakeup_ns = 0;
  bool operator==(const LayoutDevice&) const = default;
};

struct LayoutLink {
  std::string name;
  std::uint32_t a = 0, b = 0;  ///< nodes
  std::uint64_t bps = 0;
  std::uint64_t latency_ns = 0;
  bool operator==(const LayoutLink&) const = default;
};

struct Layout {
  std::string machine, machine_hash;
  std::vector<LayoutNode> nodes;
  std::vector<LayoutDevice> devices;
  std::vector<LayoutLink> links;
  std::uint32_t main_node = 0, sensor_node = 0;
  bool operator==(const Layout&) const = default;
};

Layout make_layout(const profile::Machine& machine);
/// Throws profile::Error unless every id exists, every two nodes have one link, and every number is
/// in range: what a Timeline relies on, whatever file a layout came from.
void check_layout(const Layout& layout);

/// What a command asks of its engine: launch_ns, then compute and memory traffic side by side. The
/// timeline stretches the second part when the memory is shared. For a CPU device `units` cores
/// share compute_ns, which is the time when all of them work.
struct Demand {
  Ns launch_ns = 0;
  Ns compute_ns = 0;
  Ns memory_ns = 0;  ///< time of the traffic alone, at the most this command can draw
  std::uint64_t bytes = 0;
  std::uint32_t units = 1;
  bool operator==(const Demand&) const = default;
};
inline Demand demand_of(const model::Cost& c) {
  return {c.launch_ns, c.compute_ns, c.memory_ns, c.bytes, c.units};
}

}  // namespace partita::timeline

#endif  // PARTITA_DEVICES_TIMELINE_LAYOUT_H
