// Work of the back-end's host steps, in double precision.
#include "host/tasks/backend/kernels.h"

namespace partita::backend {

using runtime::HostSpec;
using runtime::Shape;

const HostSpec& factorise_spec() {
  static const HostSpec spec{"factorise", "backend", [](const Shape& shape) {
                               const auto n = static_cast<std::uint64_t>(shape["unknowns"]);
                               const auto terms = static_cast<std::uint64_t>(shape["terms"]);
                               Work work;
                               work.kind = WorkKind::dense;
                               work[OpClass::double_fma] = terms;
                               work[OpClass::double_special] = 2 * n;
                               work.read_issued = work.read_unique = n * n * 8 / 2 + n * 8;
                               work.written_issued = work.written_unique = n * 8;
                               return work;
                             }};
  return spec;
}

const HostSpec& gain_ratio_spec() {
  static const HostSpec spec{"gain_ratio", "backend", [](const Shape& shape) {
                               const auto n = static_cast<std::uint64_t>(shape["unknowns"]);
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::double_fma] = 3 * n + 10;
                               work[OpClass::double_special] = 4;
                               work.read_issued = work.read_unique = 3 * n * 8;
                               work.written_issued = work.written_unique = 8;
                               return work;
                             }};
  return spec;
}

std::vector<const HostSpec*> host_specs() {
  return {&factorise_spec(), &gain_ratio_spec()};
}

}  // namespace partita::backend
