#include "partition/search/usage.h"

namespace partita::partition {

Usage usage(const Evaluator& evaluator, const TaskPlacement& placement) {
  const profile::Machine& machine = evaluator.machine();
  Usage used{std::vector<bool>(machine.devices.size()), std::vector<bool>(machine.nodes.size()),
             std::vector<bool>(machine.links.size())};
  std::vector<std::uint32_t> node_of;
  const auto cross = [&](std::uint32_t from, std::uint32_t to) {
    for (std::size_t l = 0; l < machine.links.size(); ++l) {
      const profile::NetworkLink& link = machine.links[l];
      if ((link.a == from && link.b == to) || (link.a == to && link.b == from)) {
        used.links[l] = true;
      }
    }
  };
  for (std::uint32_t t = 0; t < placement.size(); ++t) {
    const Place& place = evaluator.places(t)[placement[t]];
    if (place.is_device && !machine.devices[place.index].is_host_cpu) {
      used.devices[place.index] = true;
    }
    const std::uint32_t node = place.is_device ? machine.devices[place.index].node : place.index;
    used.nodes[node] = true;
    node_of.push_back(node);
    const PipelineTask& task = evaluator.pipeline().tasks[t];
    for (const Input& input : task.inputs) cross(node_of[input.task], node);
    if (task.inputs.empty()) cross(machine.sensor_node, node);
  }
  return used;
}

Speeds as_declared(const profile::Machine& machine) {
  return {
      std::vector<double>(machine.devices.size(), 1), std::vector<double>(machine.nodes.size(), 1),
      std::vector<double>(machine.links.size(), 1), std::vector<double>(machine.devices.size(), 1)};
}

}  // namespace partita::partition
