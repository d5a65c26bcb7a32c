// The detection task's kernels, for whoever runs, checks, packages or lists them.
#ifndef PARTITA_HOST_TASKS_DETECTION_KERNELS_H
#define PARTITA_HOST_TASKS_DETECTION_KERNELS_H

#include <vector>

#include "host/runtime/kernel_spec.h"

namespace partita::detection {

/// All kernels of the task; Session wants them.
std::vector<const runtime::KernelSpec*> kernel_specs();

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_KERNELS_H
