// DeviceModel: how long Work takes on a device, in integer nanoseconds. Pure functions of profile,
// Work and launch: the same inputs give the same nanoseconds everywhere. docs/predicted-clock.md
// derives the formulas and says where their constants come from.
#ifndef PARTITA_DEVICES_MODEL_MODEL_H
#define PARTITA_DEVICES_MODEL_MODEL_H

#include <cstdint>
#include <string>
#include <string_view>

#include "devices/profile/profile.h"
#include "devices/work.h"

namespace partita::model {

/// The geometry of a launch; a GPU's occupancy follows from it. A host step has none.
struct Launch {
  std::uint64_t groups = 1;       ///< work-groups
  std::uint64_t group_items = 1;  ///< work-items of one work-group
  std::uint64_t local_bytes = 0;  ///< __local memory of one work-group
};

/// What a container says of an FPGA kernel; zeros: the profile's clock, one memory port.
struct Circuit {
  double clock_hz = 0;
  std::uint32_t memory_ports = 0;
  std::uint32_t compute_units = 0;
};

enum class Bound : std::uint8_t { launch, compute, memory, local_memory, port, occupancy };
std::string_view to_string(Bound bound);
std::string_view to_string(OpClass c);
std::string_view to_string(WorkKind k);

/// The duration's parts, for a device that has its memory to itself:
///   duration = launch + max(compute, memory)
/// `compute_ns` is the time of everything that does not cross the memory bus. `bytes` cross it and
/// draw at most bytes / memory_ns; the timeline stretches the command when others draw as well.
struct Cost {
  std::uint64_t launch_ns = 0;
  std::uint64_t compute_ns = 0;
  std::uint64_t memory_ns = 0;
  std::uint64_t bytes = 0;
  std::uint32_t units = 1;  ///< CPU cores that can share compute_ns (compute_ns is for all of them)
  Bound bound = Bound::launch;
  OpClass heaviest = OpClass::int_add;  ///< class of operations that takes most of compute_ns

  std::uint64_t busy_ns() const { return compute_ns > memory_ns ? compute_ns : memory_ns; }
  std::uint64_t total_ns() const { return launch_ns + busy_ns(); }
};

/// Built once per device; each cost is some tens of floating-point operations (about 30 ns).
class DeviceModel {
 public:
  explicit DeviceModel(const profile::DeviceProfile& profile);

  /// A kernel on the device. Throws profile::Error if the Work needs operations that the device
  /// does not have (doubles on an FPGA), or is absurd (more than 2^42 ns).
  Cost kernel(const Work& work, const Launch& launch, const Circuit& circuit = {}) const;
  /// A host step on one core of this (CPU) device.
  Cost host_step(const Work& work) const;
  /// `bytes` written inside the device's memory (clEnqueueFillBuffer).
  Cost fill(std::uint64_t bytes) const;
  /// `bytes` copied inside the device's memory: read and written once each.
  Cost copy(std::uint64_t bytes) const;

  const std::string& id() const { return id_; }

 private:
  Cost gpu(const Work& work, const Launch& launch) const;
  Cost fpga(const Work& work, const Circuit& circuit) const;
  Cost cpu(const Work& work, std::uint32_t cores) const;
  double compute_seconds(const Work& work, Cost& cost) const;
  Cost finish(Cost cost, double compute_s, double memory_s) const;

  std::string id_;
  profile::DeviceType type_;
  profile::Performance perf_;
  std::uint64_t launch_ns_ = 0;
  std::array<double, kOpClasses> unit_seconds_per_op_{};  ///< at efficiency 1; infinite: cannot
};

/// The sanity gate: refuses results that no
/// machine can reach. `seconds` is a time measured or predicted for `work` on the device; faster
/// than the roofline at efficiency 1, a power of zero or less (pass NaN for "unknown"), or a
/// utilisation above 1 gives one line that says which; an empty string means plausible.
std::string implausible(const profile::DeviceProfile& profile, const Work& work, double seconds,
                        double power_w, double utilisation);

}  // namespace partita::model

#endif  // PARTITA_DEVICES_MODEL_MODEL_H
