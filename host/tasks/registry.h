// All kernels of all tasks, for whoever treats them alike: verify, package, the tests.
#ifndef PARTITA_HOST_TASKS_REGISTRY_H
#define PARTITA_HOST_TASKS_REGISTRY_H

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/runtime/kernel_spec.h"

namespace partita::tasks {

struct Task {
  std::string_view name;
  std::vector<const runtime::KernelSpec*> kernels;
  /// Whether its circuits are in the container that a vehicle's FPGA loads. Where they are not, a
  /// command that runs them packages a container of its own.
  bool in_vehicle = true;
};

std::span<const Task> all_tasks();

/// Throws Error that lists the tasks there are.
const Task& find_task(std::string_view name);

/// The kernels of the named tasks, of all tasks if none is named, that have the variant.
std::vector<const runtime::KernelSpec*> kernels_of(std::span<const std::string> tasks,
                                                   runtime::Variant variant);

/// All FPGA kernels of the container that a vehicle's FPGA loads.
std::vector<const runtime::KernelSpec*> vehicle_kernels();

}  // namespace partita::tasks

#endif  // PARTITA_HOST_TASKS_REGISTRY_H
