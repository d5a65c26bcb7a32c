#include "devices/profile/machine.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "devices/profile/reader.h"
#include "devices/profile/schema.h"

namespace fs = std::filesystem;

namespace partita::profile {
namespace {

/// Builds a Machine from its file; keeps the profiles it has read, for the hash.
class MachineLoader {
 public:
  MachineLoader(const std::string& path, const std::string& profiles)
      : profiles_(profiles), text_(read_file(path)) {
    machine_.path = path;
    machine_.id = fs::path(path).stem().string();
  }

  Machine load() {
    const Reader reader = Reader::parse(text_, machine_.path, &machine_.numbers);
    reader.allow({"description", "nodes", "links", "main_node", "sensor_node"});
    machine_.description = reader.text("description");
    read_nodes(reader.section("nodes"));
    if (reader.has("links")) read_links(reader.section("links"));
    machine_.main_node = node_at(reader, "main_node");
    machine_.sensor_node = node_at(reader, "sensor_node");
    check_joined(reader);
    std::string hashes = hash_bytes(text_);
    for (const auto& [name, device] : read_) hashes += " " + name + " " + device.content_hash;
    machine_.content_hash = hash_bytes(hashes);
    return std::move(machine_);
  }

 private:
  const DeviceProfile& profile(const Reader& reader, std::string_view key,
                               const std::string& name) {
    const auto known = read_.find(name);
    if (known != read_.end()) return known->second;
    const fs::path path = fs::path(profiles_) / "devices" / (name + ".yaml");
    if (!plain_name(name) || !fs::exists(path)) {
      reader.fail(key, "no device profile '" + name.substr(0, 40) + "', expected one of " +
                           listed(list_devices(profiles_)));
    }
    return read_.emplace(name, load_device(path.string())).first->second;
  }

  void read_nodes(const Reader& nodes) {
    for (const auto& name : nodes.keys()) {
      if (!plain_name(name)) nodes.fail(name, "not a name, expected letters, digits, '-' and '_'");
      const Reader node = nodes.section(name);
      node.allow({"host", "devices"});
      const std::string host = node.text("host");
      machine_.nodes.push_back({name, profile(node, "host", host)});
      if (machine_.nodes.back().host.type != DeviceType::cpu) {
        node.fail("host", "'" + host + "' is not a cpu, expected a profile of type cpu");
      }
      if (node.has("devices")) read_devices(node, host);
    }
    if (machine_.nodes.empty()) nodes.fail("", "no node, expected at least one");
    if (machine_.devices.empty()) nodes.fail("", "no device on any node, expected at least one");
    nodes.allow(views(nodes.keys()));
  }

  void read_devices(const Reader& node, const std::string& host) {
    const auto index = static_cast<std::uint32_t>(machine_.nodes.size() - 1);
    std::string name;
    std::string rest = node.words("devices") + " ";
    for (std::size_t from = 0, to; (to = rest.find(' ', from)) != std::string::npos;
         from = to + 1) {
      name = rest.substr(from, to - from);
      const DeviceProfile& device = profile(node, "devices", name);
      for (const auto& other : machine_.devices) {
        if (other.name == name) node.fail("devices", "'" + name + "' twice, expected once");
      }
      if (device.type == DeviceType::cpu && name != host) {
        node.fail("devices", "'" + name + "' is a cpu beside the host, expected the host itself");
      }
      machine_.devices.push_back({name, device, index, device.type == DeviceType::cpu});
    }
  }

  void read_links(const Reader& links) {
    links.allow(views(links.keys()));
    for (const auto& name : links.keys()) {
      if (!plain_name(name)) links.fail(name, "not a name, expected letters, digits, '-' and '_'");
      const Reader link = links.section(name);
      link.allow({"from", "to", "bandwidth", "latency", "transfer", "uncertainty"});
      NetworkLink to;
      to.name = name;
      to.a = node_at(link, "from");
      to.b = node_at(link, "to");
      if (to.a == to.b) link.fail("to", "the same node as 'from', expected another");
      to.bandwidth = link.number("bandwidth", {"B/s", 1e3, 1e13});
      to.latency_ns = link.integer("latency", {"ns", 0, 1e10});
      to.transfer_j_per_byte = link.number("transfer", {"J/B", 1e-13, 1e-3});
      to.uncertainty = read_uncertainty(link);
      machine_.links.push_back(to);
    }
  }

  std::uint32_t node_at(const Reader& reader, std::string_view key) const {
    std::vector<std::string_view> names;
    for (const auto& node : machine_.nodes) names.push_back(node.name);
    return static_cast<std::uint32_t>(reader.choice(key, names));
  }

  /// Every two nodes need a link of their own: a copy crosses at most one.
  void check_joined(const Reader& reader) const {
    const auto& nodes = machine_.nodes;
    for (std::uint32_t a = 0; a < nodes.size(); ++a) {
      for (std::uint32_t b = a + 1; b < nodes.size(); ++b) {
        const auto joins = [&](const NetworkLink& l) {
          return (l.a == a && l.b == b) || (l.a == b && l.b == a);
        };
        const auto count = std::count_if(machine_.links.begin(), machine_.links.end(), joins);
        if (count != 1) {
          reader.fail("links", std::to_string(count) + " links join '" + nodes[a].name + "' and '" +
                                   nodes[b].name + "', expected one");
        }
      }
    }
  }

  static std::vector<std::string_view> views(const std::vector<std::string>& names) {
    return {names.begin(), names.end()};
  }

  Machine machine_;
  std::string profiles_;
  std::string text_;
  std::map<std::string, DeviceProfile> read_;
};

}  // namespace

Machine load_machine(const std::string& what, const std::string& profiles) {
  std::string path = what;
  if (what.find('/') == std::string::npos && !what.ends_with(".yaml")) {
    const auto names = list_machines(profiles);
    if (std::find(names.begin(), names.end(), what) == names.end()) {
      throw Error("machine '" + what + "': not in " + profiles + "/machines, expected one of " +
                  listed(names));
    }
    path = (fs::path(profiles) / "machines" / (what + ".yaml")).string();
  }
  const std::string folder =
      profiles.empty() ? fs::absolute(path).parent_path().parent_path().string() : profiles;
  try {
    return MachineLoader(path, folder).load();
  } catch (const YAML::Exception& e) {
    throw Error(path + ":" + std::to_string(std::max(e.mark.line, 0) + 1) + ": " + e.msg);
  }
}

std::vector<std::string> list_machines(const std::string& profiles) {
  return yaml_stems((fs::path(profiles) / "machines").string());
}

std::vector<std::string> list_devices(const std::string& profiles) {
  return yaml_stems((fs::path(profiles) / "devices").string());
}

}  // namespace partita::profile
