// clEnqueueNDRangeKernel and clEnqueueTask: the device's limits, then the launch, then its cost.
#include "devices/layer/launch.h"

#include <algorithm>

#include "devices/layer/calls.h"
#include "devices/layer/declared_work.h"
#include "devices/layer/enqueue.h"
#include "devices/layer/estimate.h"

namespace partita::layer {
namespace {

constexpr std::size_t kChosenItems = 256;

std::size_t largest_divisor(std::size_t n, std::size_t most) {
  for (std::size_t d = std::min(n, most); d > 1; --d) {
    if (n % d == 0) return d;
  }
  return 1;
}

void choose_local(const Kernel& kernel, const Device& device, cl_uint dimensions,
                  const std::size_t* global, Sizes& local) {
  std::size_t left = std::min(kChosenItems, group_limit(kernel, device));
  for (cl_uint i = 0; i < dimensions; ++i) {
    local[i] =
        largest_divisor(global[i], std::min<std::size_t>(left, device.cl.max_work_item_sizes[i]));
    left /= local[i];
  }
}

cl_int check_local(const Kernel& kernel, const Device& device, cl_uint dimensions,
                   const std::size_t* global, const Sizes& local) {
  std::size_t items = 1;
  for (cl_uint i = 0; i < dimensions; ++i) {
    if (local[i] == 0) return CL_INVALID_WORK_GROUP_SIZE;
    if (local[i] > device.cl.max_work_item_sizes[i]) return CL_INVALID_WORK_ITEM_SIZE;
    if (global[i] % local[i] != 0) return CL_INVALID_WORK_GROUP_SIZE;
    items *= local[i];
    if (items > group_limit(kernel, device)) return CL_INVALID_WORK_GROUP_SIZE;
  }
  return CL_SUCCESS;
}

/// What the model takes of a launch: its groups, its items and its local memory.
model::Launch geometry(const Device& device, const Kernel& kernel, cl_uint dimensions,
                       const std::size_t* global, const Sizes& local) {
  model::Launch launch;
  for (cl_uint i = 0; i < dimensions; ++i) {
    launch.groups *= std::max<std::size_t>(1, global[i] / std::max<std::size_t>(1, local[i]));
    launch.group_items *= local[i];
  }
  launch.local_bytes = local_memory(kernel, device);
  return launch;
}

std::uint64_t reachable_bytes(const Kernel& kernel) {
  const Lock lock(state().mutex);
  std::uint64_t bytes = 0;
  for (const KernelArg& arg : kernel.args) {
    if (!arg.memory) continue;
    const auto memory = state().memories.find(arg.memory);
    bytes += memory ? memory->bytes : 0;
  }
  return bytes;
}

model::Circuit circuit_of(const Kernel& kernel) {
  model::Circuit circuit;
  if (kernel.circuit) {
    circuit.clock_hz = kernel.program->container->container.clock_mhz * 1e6;
    circuit.memory_ports = kernel.circuit->design.memory_ports;
    circuit.compute_units = kernel.circuit->design.compute_units;
  }
  return circuit;
}

/// Work declared for this launch, or the estimate.
Work work_of(cl_command_queue queue, cl_kernel handle, Kernel& kernel,
             const model::Launch& launch) {
  Work work;
  if (take_declared_work(queue, work)) return work;
  const auto estimate = estimate_of(handle, kernel);
  return estimated_work(*estimate, launch.groups * launch.group_items, reachable_bytes(kernel),
                        kernel.circuit);
}

cl_int launch(const Enqueue& e, const Queue& queue, cl_kernel handle, Kernel& kernel,
              cl_uint dimensions, const std::size_t* offset, const std::size_t* global,
              const std::size_t* given) {
  const Device& device = *queue.device;
  Sizes local{1, 1, 1};
  if (const cl_int error = check_launch(kernel, device, dimensions, global, given, local);
      error != CL_SUCCESS) {
    return error;
  }
  model::Launch shape = geometry(device, kernel, dimensions, global, local);
  const Work work = work_of(e.queue, handle, kernel, shape);
  if (work.groups > 0) shape = {work.groups, work.group_items, work.group_local_bytes};
  timeline::Command command;
  command.kind = timeline::CommandKind::kernel;
  command.name = kernel.name_id;
  command.work = &work;
  command.launch = shape;
  try {
    command.demand = timeline::demand_of(device.model.kernel(work, shape, circuit_of(kernel)));
  } catch (const profile::Error& error) {
    const std::string line = "kernel '" + kernel.name + "': " + error.what();
    queue.context->tell(line);
    say_once(line);
    return CL_OUT_OF_RESOURCES;
  }
  if (kernel.circuit) {
    command.compute_units = std::clamp(kernel.circuit->design.compute_units, 1u, 64u);
  }
  const std::vector<MemoryUse> uses = uses_of(kernel, queue);
  Enqueue placed = e;
  placed.uses = uses;
  return enqueue_on(queue, placed, command, [&](cl_event* event) {
    return target().clEnqueueNDRangeKernel(e.queue, handle, dimensions, offset, global,
                                           local.data(), e.wait_count, e.waits, event);
  });
}

cl_int CL_API_CALL enqueue_nd_range(cl_command_queue queue_handle, cl_kernel handle,
                                    cl_uint dimensions, const std::size_t* offset,
                                    const std::size_t* global, const std::size_t* local,
                                    cl_uint wait_count, const cl_event* waits, cl_event* event) {
  return guarded([&]() -> cl_int {
    std::shared_ptr<Queue> queue;
    std::shared_ptr<Kernel> kernel;
    {
      const Lock lock(state().mutex);
      queue = state().queues.find(queue_handle);
      kernel = state().kernels.find(handle);
    }
    if (!queue) return CL_INVALID_COMMAND_QUEUE;
    if (!kernel) return CL_INVALID_KERNEL;
    // What OpenCL leaves to the driver: launches of nothing.
    const bool plain = dimensions >= 1 && dimensions <= 3 && global &&
                       std::count(global, global + dimensions, std::size_t{0}) == 0;
    const Enqueue e{queue_handle, wait_count, waits, event, false};
    if (plain) {
      return launch(e, *queue, handle, *kernel, dimensions, offset, global, local);
    }
    timeline::Command nothing;
    nothing.kind = timeline::CommandKind::marker;
    return enqueue(e, nothing, [&](cl_event* ev) {
      return target().clEnqueueNDRangeKernel(queue_handle, handle, dimensions, offset, global,
                                             local, wait_count, waits, ev);
    });
  });
}

cl_int CL_API_CALL enqueue_task(cl_command_queue queue, cl_kernel kernel, cl_uint wait_count,
                                const cl_event* waits, cl_event* event) {
  const std::size_t one = 1;
  return enqueue_nd_range(queue, kernel, 1, nullptr, &one, &one, wait_count, waits, event);
}

/// Only a CPU runs host functions as commands. They take no predicted time.
cl_int CL_API_CALL enqueue_native(cl_command_queue queue_handle, void(CL_CALLBACK* function)(void*),
                                  void* args, std::size_t args_bytes, cl_uint mem_count,
                                  const cl_mem* mems, const void** locations, cl_uint wait_count,
                                  const cl_event* waits, cl_event* event) {
  return guarded([&]() -> cl_int {
    const auto queue = find_queue(queue_handle);
    if (queue && queue->device->profile.type != profile::DeviceType::cpu) {
      return CL_INVALID_OPERATION;
    }
    timeline::Command command;
    command.kind = timeline::CommandKind::marker;
    return enqueue({queue_handle, wait_count, waits, event, false}, command, [&](cl_event* ev) {
      return target().clEnqueueNativeKernel(queue_handle, function, args, args_bytes, mem_count,
                                            mems, locations, wait_count, waits, ev);
    });
  });
}

}  // namespace

cl_int check_launch(const Kernel& kernel, const Device& device, cl_uint dimensions,
                    const std::size_t* global, const std::size_t* given, Sizes& local) {
  const bool has_required = kernel.required[0] != 0;
  if (given) {
    std::copy_n(given, dimensions, local.begin());
  } else if (has_required) {
    return CL_INVALID_WORK_GROUP_SIZE;
  } else {
    choose_local(kernel, device, dimensions, global, local);
  }
  if (has_required && local != Sizes(kernel.required)) return CL_INVALID_WORK_GROUP_SIZE;
  const cl_int error = check_local(kernel, device, dimensions, global, local);
  if (error != CL_SUCCESS) return error;
  return local_memory(kernel, device) > device.cl.local_mem_size ? CL_OUT_OF_RESOURCES : CL_SUCCESS;
}

void add_launch_calls(cl_icd_dispatch& table) {
  table.clEnqueueNDRangeKernel = enqueue_nd_range;
  table.clEnqueueTask = enqueue_task;
  table.clEnqueueNativeKernel = enqueue_native;
}

}  // namespace partita::layer
