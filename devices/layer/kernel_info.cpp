// Queries about kernels: limits from the profile, the rest from the compiler underneath.
#include <algorithm>

#include "devices/layer/answer.h"
#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/launch.h"
#include "devices/layer/program.h"

namespace partita::layer {

std::shared_ptr<Kernel> find_kernel(cl_kernel handle) {
  const Lock lock(state().mutex);
  return state().kernels.find(handle);
}

std::size_t group_limit(const Kernel& kernel, const Device& device) {
  return std::min<std::size_t>(kernel.group_limit ? kernel.group_limit : SIZE_MAX,
                               device.cl.max_work_group_size);
}

std::uint64_t local_memory(const Kernel& kernel, const Device& device) {
  return kernel.local_args() + (device.is_fpga() ? 0 : kernel.static_local);
}

namespace {

cl_int CL_API_CALL get_work_group_info(cl_kernel handle, cl_device_id device_handle,
                                       cl_kernel_work_group_info name, std::size_t size,
                                       void* value, std::size_t* size_ret) {
  return guarded([&]() -> cl_int {
    const auto kernel = find_kernel(handle);
    if (!kernel) {
      return target().clGetKernelWorkGroupInfo(handle, device_handle, name, size, value, size_ret);
    }
    const auto& devices = kernel->program->devices;
    if (!device_handle && devices.size() == 1) device_handle = devices[0]->handle;
    if (!device_handle || check_device_list(devices, 1, &device_handle) != CL_SUCCESS) {
      return CL_INVALID_DEVICE;
    }
    const Device& device = *find_device(device_handle);
    const Answer answer(size, value, size_ret);
    switch (name) {
      case CL_KERNEL_WORK_GROUP_SIZE:
        return answer.put<std::size_t>(group_limit(*kernel, device));
      case CL_KERNEL_PREFERRED_WORK_GROUP_SIZE_MULTIPLE:
        return answer.put<std::size_t>(device.cl.preferred_work_group_multiple);
      case CL_KERNEL_LOCAL_MEM_SIZE: {
        const Lock lock(state().mutex);
        return answer.put<cl_ulong>(local_memory(*kernel, device));
      }
      case CL_KERNEL_GLOBAL_WORK_SIZE:  // custom devices and built-in kernels only
        return CL_INVALID_VALUE;
      default:
        return target().clGetKernelWorkGroupInfo(handle, device_handle, name, size, value,
                                                 size_ret);
    }
  });
}

/// The driver always has argument info, the program only if it asked for it.
cl_int CL_API_CALL get_arg_info(cl_kernel handle, cl_uint index, cl_kernel_arg_info name,
                                std::size_t size, void* value, std::size_t* size_ret) {
  return guarded([&]() -> cl_int {
    const auto kernel = find_kernel(handle);
    if (kernel && index < kernel->args.size() && !kernel->program->keeps_arg_info) {
      return CL_KERNEL_ARG_INFO_NOT_AVAILABLE;
    }
    return target().clGetKernelArgInfo(handle, index, name, size, value, size_ret);
  });
}

}  // namespace

void add_kernel_info_calls(cl_icd_dispatch& table) {
  table.clGetKernelWorkGroupInfo = get_work_group_info;
  table.clGetKernelArgInfo = get_arg_info;
}

}  // namespace partita::layer
