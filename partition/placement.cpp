#include "partition/placement.h"

#include <algorithm>
#include <bitset>

#include "devices/profile/error.h"
#include "partition/text.h"

namespace partita::partition {
namespace {

Branch parse_branch(std::string_view name) {
  for (const Branch branch : kBranches) {
    if (to_string(branch) == name) return branch;
  }
  throw profile::Error("placement: no task '" + std::string(name) +
                       "', expected one of localization, scene");
}

}  // namespace

std::string_view to_string(Branch branch) {
  return branch == Branch::localization ? "localization" : "scene";
}

std::string Placement::to_string() const {
  std::string text;
  for (const Branch branch : kBranches) {
    text += text.empty() ? "" : ",";
    text += std::string(partition::to_string(branch)) + "=" + of(branch);
  }
  return text;
}

Placement parse_placement(std::string_view text, const Placement& defaults) {
  Placement placement = defaults;
  std::bitset<kBranches.size()> seen;
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    const std::size_t equals = item.find('=');
    const std::string_view name = trimmed(item.substr(0, equals));
    const std::string_view device =
        equals == std::string_view::npos ? "" : trimmed(item.substr(equals + 1));
    if (device.empty()) {
      throw profile::Error("placement: '" + std::string(item) +
                           "' is not TASK=DEVICE, for instance localization=fpga");
    }
    const auto index = static_cast<std::size_t>(parse_branch(name));
    if (seen.test(index)) {
      throw profile::Error("placement: task '" + std::string(name) + "' is placed twice");
    }
    seen.set(index);
    placement.device[index] = device;
    text.remove_prefix(std::min(text.size(), item.size() + 1));
  }
  return placement;
}

}  // namespace partita::partition
