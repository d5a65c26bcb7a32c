#include "partition/search/pins.h"

#include <algorithm>
#include <cctype>
#include <limits>

#include "devices/profile/error.h"
#include "partition/text.h"

namespace partita::partition {
namespace {

constexpr std::size_t kShortestPart = 3;

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

[[noreturn]] void refuse(const Pin& pin, const std::string& why) {
  throw PinError("pin '" + pin.to_string() + "': " + why);
}

struct Spot {
  const profile::DeviceProfile& profile;
  const std::string& node;
};

Spot spot(const profile::Machine& machine, const Place& place) {
  if (!place.is_device) {
    return {machine.nodes[place.index].host, machine.nodes[place.index].name};
  }
  const profile::MachineDevice& device = machine.devices[place.index];
  return {device.profile, machine.nodes[device.node].name};
}

/// An exact name means that thing alone, although it may be a part of another's name.
bool exactly(const Spot& s, const std::string& wanted) {
  return wanted == profile::to_string(s.profile.type) || wanted == lower(s.profile.id) ||
         wanted == lower(s.node);
}

bool partly(const Spot& s, const std::string& wanted) {
  if (wanted.size() < kShortestPart) return false;
  return lower(s.profile.name).find(wanted) != std::string::npos ||
         lower(s.profile.opencl.device_name).find(wanted) != std::string::npos ||
         lower(s.profile.id).find(wanted) != std::string::npos;
}

/// How a pin's device is meant on this machine.
struct Meaning {
  std::string wanted;
  bool exact = false;
  bool covers(const Spot& s) const { return exact ? exactly(s, wanted) : partly(s, wanted); }
};

Meaning meaning(const profile::Machine& machine, const Pin& pin) {
  Meaning m{lower(pin.where), false};
  bool any = false;
  std::string names;
  const auto look = [&](const Spot& s, std::string_view name) {
    m.exact = m.exact || exactly(s, m.wanted);
    any = any || partly(s, m.wanted);
    append(names, std::string(name) + " (" + std::string(profile::to_string(s.profile.type)) + ")");
  };
  for (const profile::MachineDevice& device : machine.devices) {
    look({device.profile, machine.nodes[device.node].name}, device.name);
  }
  for (const profile::Node& node : machine.nodes) {
    look({node.host, node.name}, node.name + "/" + node.host.id);
  }
  if (!m.exact && !any) {
    refuse(pin, "machine '" + machine.id + "' has no such device, expected a kind, one of " +
                    names + ", or a part of a name, of three characters or more");
  }
  return m;
}

/// The tasks that the pin is about. Of a branch those with kernels: its host steps have no choice
/// of device, and stay where they are best.
std::vector<std::uint32_t> tasks_of(const Pipeline& pipeline, const Pin& pin) {
  std::vector<std::uint32_t> tasks;
  std::string names;
  for (std::uint32_t t = 0; t < pipeline.tasks.size(); ++t) {
    const PipelineTask& task = pipeline.tasks[t];
    if (task.name == pin.what) return {t};
    append(names, task.name);
    if (task.branch == pin.what && !task.host_only) tasks.push_back(t);
  }
  if (!tasks.empty()) return tasks;
  for (std::uint32_t t = 0; t < pipeline.tasks.size(); ++t) {
    const std::string& branch = pipeline.tasks[t].branch;
    const bool first =
        std::none_of(pipeline.tasks.begin(), pipeline.tasks.begin() + t,
                     [&](const PipelineTask& before) { return before.branch == branch; });
    if (first && !branch.empty()) append(names, branch);
  }
  refuse(pin,
         "pipeline '" + pipeline.id + "' has no such task or branch, expected one of " + names);
}

void apply(const Evaluator& evaluator, std::span<const Pin> pins, std::size_t number,
           Choices& choices) {
  const Pin& pin = pins[number];
  const profile::Machine& machine = evaluator.machine();
  const Meaning m = meaning(machine, pin);
  for (const std::uint32_t t : tasks_of(evaluator.pipeline(), pin)) {
    const std::string& task = evaluator.pipeline().tasks[t].name;
    const std::vector<Place>& places = evaluator.places(t);
    const auto outside = [&](std::uint32_t p) { return !m.covers(spot(machine, places[p])); };
    std::string names;
    for (const Place& place : places) append(names, place.name);
    if (std::none_of(places.begin(), places.end(),
                     [&](const Place& place) { return m.covers(spot(machine, place)); })) {
      refuse(pin, "task '" + task + "' cannot run there, expected one of " + names);
    }
    std::erase_if(choices[t], outside);
    if (choices[t].empty()) {
      std::string others;
      for (const Pin& other : pins.first(number)) {
        const auto about = tasks_of(evaluator.pipeline(), other);
        if (std::find(about.begin(), about.end(), t) == about.end()) continue;
        append(others, other.to_string());
      }
      refuse(pin,
             "contradicts pin " + others + " for task '" + task + "', expected one place for it");
    }
  }
}

}  // namespace

Pin parse_pin(std::string_view text) {
  const std::size_t equals = text.find('=');
  Pin pin;
  if (equals != std::string_view::npos) {
    pin.what = trimmed(text.substr(0, equals));
    pin.where = trimmed(text.substr(equals + 1));
  }
  if (pin.what.empty() || pin.where.empty() || pin.where.find('=') != std::string::npos) {
    throw PinError("pin '" + std::string(text) +
                   "' is not TASK=DEVICE, expected for instance depth=gpu");
  }
  return pin;
}

Choices choices(const Evaluator& evaluator, std::span<const Pin> pins) {
  Choices all(evaluator.pipeline().tasks.size());
  for (std::uint32_t t = 0; t < all.size(); ++t) {
    all[t].resize(evaluator.places(t).size());
    for (std::uint32_t p = 0; p < all[t].size(); ++p) all[t][p] = p;
  }
  for (std::size_t i = 0; i < pins.size(); ++i) apply(evaluator, pins, i, all);
  return all;
}

std::uint64_t count(const Choices& choices) {
  std::uint64_t product = 1;
  for (const auto& places : choices) {
    if (__builtin_mul_overflow(product, places.size(), &product)) {
      return std::numeric_limits<std::uint64_t>::max();
    }
  }
  return product;
}

TaskPlacement nth(const Choices& choices, std::uint64_t number) {
  TaskPlacement placement(choices.size());
  for (std::size_t t = choices.size(); t-- > 0;) {
    placement[t] = choices[t][number % choices[t].size()];
    number /= choices[t].size();
  }
  return placement;
}

}  // namespace partita::partition
