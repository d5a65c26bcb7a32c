// Area of an FPGA design, estimated from what it instantiates. The model is simple and stated in
// docs/predicted-clock.md: block memories by shape, DSPs by operator and width, LUT and FF by
// operator, a shell per memory port and per compute unit.
#ifndef PARTITA_DEVICES_MODEL_AREA_H
#define PARTITA_DEVICES_MODEL_AREA_H

#include <string>

#include "devices/profile/profile.h"
#include "devices/work.h"

namespace partita::model {

/// Resources of `design` with all its compute units. Never decreases when a field of it grows.
profile::Area estimate_area(const FpgaDesign& design);

profile::Area operator+(const profile::Area& a, const profile::Area& b);

/// Empty if `area` fits the device, else one line: which resource, needed and available.
std::string misfit(const profile::Area& area, const profile::DeviceProfile& device);
inline bool fits(const profile::Area& area, const profile::DeviceProfile& device) {
  return misfit(area, device).empty();
}

}  // namespace partita::model

#endif  // PARTITA_DEVICES_MODEL_AREA_H
