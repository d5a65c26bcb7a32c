// KernelChecker: runs a kernel on a device and holds every output against the golden reference.
// `partita verify` and the kernels' tests are both this.
#ifndef PARTITA_HOST_RUNTIME_CHECKER_H
#define PARTITA_HOST_RUNTIME_CHECKER_H

#include <cstddef>
#include <cstdint>
#include <string>

#include "host/runtime/session.h"

namespace partita::runtime {

struct CheckResult {
  bool equal = true;
  std::size_t compared = 0;   ///< elements compared
  std::size_t different = 0;  ///< elements outside the tolerance
  double largest_error = 0;   ///< largest absolute difference
  std::string first;          ///< "argument 'score' [12]: 7, expected 9"; empty if equal
};

/// Runs `spec` once on the session's device for a seeded case of `shape`. Outputs are compared
/// element by element; what the kernel should leave alone is compared too, and a guard zone behind
/// each buffer shows writes out of bounds.
CheckResult check_kernel(const Session& session, const KernelSpec& spec, const Shape& shape,
                         std::uint32_t seed = 1);

}  // namespace partita::runtime

#endif  // PARTITA_HOST_RUNTIME_CHECKER_H
