// Machine: a vehicle's computer. Nodes (each with a host CPU and a memory), devices on the nodes,
// links between nodes, the node that the sensors are wired to. Read from one YAML file that names
// device profiles.
#ifndef PARTITA_DEVICES_PROFILE_MACHINE_H
#define PARTITA_DEVICES_PROFILE_MACHINE_H

#include <cstdint>
#include <string>
#include <vector>

#include "devices/profile/profile.h"

namespace partita::profile {

struct Node {
  std::string name;
  DeviceProfile host;  ///< the CPU that runs host code here; its memory is the node's memory
};

/// An OpenCL device that the machine shows. Its place in Machine::devices is its DeviceId
/// everywhere (model, timeline, layer, record).
struct MachineDevice {
  std::string name;
  DeviceProfile profile;
  std::uint32_t node = 0;
  bool is_host_cpu = false;  ///< the node's host CPU itself: kernels and host steps share its cores
};

/// Joins two nodes; each direction is an engine of its own.
struct NetworkLink {
  std::string name;
  std::uint32_t a = 0, b = 0;
  double bandwidth = 0;  ///< B/s per direction, payload
  std::uint64_t latency_ns = 0;
  double transfer_j_per_byte = 0;
  std::optional<double> uncertainty;  ///< as a device's
};

struct Machine {
  std::string id;  ///< the file's stem: "dragonfly"
  std::string description;
  std::vector<Node> nodes;
  std::vector<MachineDevice> devices;
  std::vector<NetworkLink> links;
  std::uint32_t main_node = 0;      ///< where unbound host threads run
  std::uint32_t sensor_node = 0;    ///< where sensor data arrives
  std::vector<Provenance> numbers;  ///< of the machine file itself
  std::string path;
  std::string content_hash;  ///< over the machine file and all its device profiles
};

/// `what` is a path (contains '/' or ends in .yaml) or a name looked up as
/// `<profiles>/machines/<what>.yaml`; device profiles come from `<profiles>/devices`, where
/// `profiles` defaults to the folder above the machine file's own. An unknown name throws Error
/// that lists what there is.
Machine load_machine(const std::string& what, const std::string& profiles = "");

/// Names that `<profiles>/machines` and `<profiles>/devices` offer, sorted.
std::vector<std::string> list_machines(const std::string& profiles);
std::vector<std::string> list_devices(const std::string& profiles);

}  // namespace partita::profile

#endif  // PARTITA_DEVICES_PROFILE_MACHINE_H
