// Steps on the host: what the device's peaks mean, and which detection is whose.
#include "host/tasks/tracking/kernels.h"
#include "host/tasks/tracking/spec_helpers.h"

namespace partita::tracking {

using runtime::HostSpec;
using runtime::Shape;

/// Per patch a product and a comparison; per target two parabolas (6 operations and a division
/// each), the window's side (a root) and the new box.
const HostSpec& locate_spec() {
  static const HostSpec spec{"locate", "tracking", [](const Shape& shape) {
                               const std::uint64_t targets = count_of(shape, "targets");
                               const std::uint64_t patches = count_of(shape, "patches");
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::double_add] = patches + targets * 20;
                               work[OpClass::double_mul] = patches + targets * 14;
                               work[OpClass::double_special] = targets * 4;
                               work.read_issued = work.read_unique =
                                   patches * kPeakEntries * kFloat + targets * 32;
                               work.written_issued = work.written_unique = targets * 40;
                               return work;
                             }};
  return spec;
}

/// Overlaps of all pairs (12 sums and comparisons, 3 products, a division), then the Hungarian
/// algorithm: the smaller number squared times the larger one, four operations each.
const HostSpec& associate_spec() {
  static const HostSpec spec{"associate", "tracking", [](const Shape& shape) {
                               const std::uint64_t targets = count_of(shape, "targets");
                               const std::uint64_t detections = count_of(shape, "detections");
                               const std::uint64_t pairs = targets * detections;
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::double_add] =
                                   pairs * 12 + pairs * std::min(targets, detections) * 4;
                               work[OpClass::double_mul] = pairs * 3;
                               work[OpClass::double_special] = pairs;
                               work.read_issued = work.read_unique = detections * 40 + targets * 32;
                               work.written_issued = work.written_unique = targets * 40;
                               return work;
                             }};
  return spec;
}

std::vector<const HostSpec*> host_specs() {
  return {&locate_spec(), &associate_spec()};
}

}  // namespace partita::tracking
