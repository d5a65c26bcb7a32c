#include "host/tasks/registry.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/tasks/backend/kernels.h"
#include "host/tasks/depth/kernels.h"
#include "host/tasks/detection/kernels.h"
#include "host/tasks/frontend/kernels.h"
#include "host/tasks/tracking/kernels.h"

namespace partita::tasks {

std::span<const Task> all_tasks() {
  static const std::array tasks{Task{"frontend", frontend::kernel_specs()},
                                Task{"depth", depth::kernel_specs()},
                                Task{"detection", detection::kernel_specs(), false},
                                Task{"tracking", tracking::kernel_specs(), false},
                                Task{"backend", backend::kernel_specs(), false}};
  return tasks;
}

const Task& find_task(std::string_view name) {
  std::string known;
  for (const Task& task : all_tasks()) {
    if (task.name == name) return task;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", task.name);
  }
  throw Error(fmt::format("no task '{}', expected one of {}", name, known));
}

std::vector<const runtime::KernelSpec*> kernels_of(std::span<const std::string> tasks,
                                                   runtime::Variant variant) {
  std::vector<const runtime::KernelSpec*> kernels;
  const auto add = [&](const Task& task) {
    std::copy_if(task.kernels.begin(), task.kernels.end(), std::back_inserter(kernels),
                 [variant](const runtime::KernelSpec* spec) { return spec->has(variant); });
  };
  if (tasks.empty()) {
    for (const Task& task : all_tasks()) add(task);
  }
  for (const std::string& name : tasks) add(find_task(name));
  return kernels;
}

std::vector<const runtime::KernelSpec*> vehicle_kernels() {
  std::vector<std::string> tasks;
  for (const Task& task : all_tasks()) {
    if (task.in_vehicle) tasks.emplace_back(task.name);
  }
  return kernels_of(tasks, runtime::Variant::fpga);
}

}  // namespace partita::tasks
