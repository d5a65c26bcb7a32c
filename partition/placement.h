// Placement: which device each branch of the perception runs on.
#ifndef PARTITA_PARTITION_PLACEMENT_H
#define PARTITA_PARTITION_PLACEMENT_H

#include <array>
#include <string>
#include <string_view>

namespace partita::partition {

/// The two independent branches of perception; the slower one sets its latency.
enum class Branch { localization, scene };
inline constexpr std::array kBranches{Branch::localization, Branch::scene};
std::string_view to_string(Branch branch);

/// A device for each branch: "fpga", "gpu", "cpu", or a part of a device's name.
struct Placement {
  std::array<std::string, kBranches.size()> device;

  const std::string& of(Branch branch) const { return device[static_cast<std::size_t>(branch)]; }
  /// "localization=fpga,scene=gpu"
  std::string to_string() const;
};

/// Reads "localization=fpga,scene=gpu", spaces around names allowed; a branch that is not named
/// keeps what `defaults` says. Throws profile::Error that names the branch and lists those there
/// are, for unknown or repeated branches and for anything that is not BRANCH=DEVICE. Whether a
/// device exists, the machine says.
Placement parse_placement(std::string_view text, const Placement& defaults);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_PLACEMENT_H
