// Steps on the host processor that matter for the prediction (a triangulation, a factorisation) are
// computed as usual and declared with their Work; undeclared host code counts as free.
#ifndef PARTITA_HOST_RUNTIME_HOST_STEP_H
#define PARTITA_HOST_RUNTIME_HOST_STEP_H

#include "host/runtime/session.h"

namespace partita::runtime {

/// Declares that the calling thread has just computed `spec` for `shape` (counts included).
inline void declare_host_step(const Session& session, const HostSpec& spec, const Shape& shape) {
  if (session.extension().present()) {
    session.extension().host_step(spec.name.c_str(), spec.work(shape));
  }
}

}  // namespace partita::runtime

#endif  // PARTITA_HOST_RUNTIME_HOST_STEP_H
