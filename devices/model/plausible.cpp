#include <algorithm>
#include <cmath>
#include <cstdio>

#include "devices/model/model.h"

namespace partita::model {
namespace {

/// The shortest time that the data sheet allows: every class of operations at its own full rate on
/// all units, side by side, and each unique byte crossing the bus once at the peak bandwidth.
double roofline_seconds(const profile::DeviceProfile& device, const Work& work) {
  const auto& p = device.performance;
  double longest = static_cast<double>(work.unique()) / p.memory_bandwidth;
  if (device.type == profile::DeviceType::fpga) {
    // Its operations are side by side in a circuit; only the fastest clock bounds the cycles.
    const double fastest = static_cast<double>(device.opencl.clock_mhz) * 1e6;
    return std::max(longest, static_cast<double>(work.cycles()) / std::max(fastest, p.clock_hz));
  }
  for (std::size_t i = 0; i < kOpClasses; ++i) {
    const double rate = p.ops_per_cycle[i] * p.clock_hz * p.units;
    if (rate > 0) longest = std::max(longest, static_cast<double>(work.ops[i]) / rate);
  }
  return longest;
}

}  // namespace

std::string implausible(const profile::DeviceProfile& profile, const Work& work, double seconds,
                        double power_w, double utilisation) {
  char text[200];
  const char* id = profile.id.c_str();
  const double bound = roofline_seconds(profile, work);
  if (!(seconds > 0) || !std::isfinite(seconds)) {
    std::snprintf(text, sizeof text, "device '%s': a time of %g s, expected more than 0", id,
                  seconds);
  } else if (seconds < bound * (1 - 1e-9)) {
    std::snprintf(text, sizeof text,
                  "device '%s': %.4g s is faster than the roofline, expected at least %.4g s", id,
                  seconds, bound);
  } else if (power_w <= 0 || std::isinf(power_w)) {
    std::snprintf(text, sizeof text, "device '%s': a power of %g W, expected more than 0", id,
                  power_w);
  } else if (power_w > 1.5 * profile.power.busy_w) {
    std::snprintf(text, sizeof text, "device '%s': a power of %g W, expected at most 1.5 x %g W",
                  id, power_w, profile.power.busy_w);
  } else if (!(utilisation >= 0 && utilisation <= 1 + 1e-9)) {
    std::snprintf(text, sizeof text, "device '%s': a utilisation of %g, expected 0 to 1", id,
                  utilisation);
  } else {
    return "";
  }
  return text;
}

}  // namespace partita::model
