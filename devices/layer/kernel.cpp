// Kernels: creation, arguments, reference counts. The layer remembers what limits and predictions
// need: local memory and required sizes.
#include <cstring>

#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/handles.h"
#include "devices/layer/program.h"

namespace partita::layer {
namespace {

template <typename T>
T kernel_value(cl_kernel kernel, cl_kernel_info name) {
  T value{};
  target().clGetKernelInfo(kernel, name, sizeof value, &value, nullptr);
  return value;
}

template <typename T>
T group_value(cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info name) {
  T value{};
  target().clGetKernelWorkGroupInfo(kernel, device, name, sizeof value, &value, nullptr);
  return value;
}

std::string kernel_name(cl_kernel kernel) {
  std::size_t bytes = 0;
  target().clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, 0, nullptr, &bytes);
  std::string name(bytes, '\0');
  target().clGetKernelInfo(kernel, CL_KERNEL_FUNCTION_NAME, bytes, name.data(), nullptr);
  return name.c_str();
}

/// Builds are made with argument info, whether or not the program asked for it.
std::vector<KernelArg> read_args(cl_kernel handle) {
  std::vector<KernelArg> args(kernel_value<cl_uint>(handle, CL_KERNEL_NUM_ARGS));
  for (cl_uint i = 0; i < args.size(); ++i) {
    cl_kernel_arg_address_qualifier where = CL_KERNEL_ARG_ADDRESS_PRIVATE;
    target().clGetKernelArgInfo(handle, i, CL_KERNEL_ARG_ADDRESS_QUALIFIER, sizeof where, &where,
                                nullptr);
    cl_kernel_arg_type_qualifier type = CL_KERNEL_ARG_TYPE_NONE;
    cl_kernel_arg_access_qualifier access = CL_KERNEL_ARG_ACCESS_NONE;
    target().clGetKernelArgInfo(handle, i, CL_KERNEL_ARG_TYPE_QUALIFIER, sizeof type, &type,
                                nullptr);
    target().clGetKernelArgInfo(handle, i, CL_KERNEL_ARG_ACCESS_QUALIFIER, sizeof access, &access,
                                nullptr);
    args[i].local = where == CL_KERNEL_ARG_ADDRESS_LOCAL;
    args[i].constant = where == CL_KERNEL_ARG_ADDRESS_CONSTANT ||
                       access == CL_KERNEL_ARG_ACCESS_READ_ONLY ||
                       (type & CL_KERNEL_ARG_TYPE_CONST) != 0;
    args[i].buffer =
        where == CL_KERNEL_ARG_ADDRESS_GLOBAL || where == CL_KERNEL_ARG_ADDRESS_CONSTANT;
  }
  return args;
}

std::shared_ptr<Kernel> describe(cl_kernel handle, std::shared_ptr<Program> program) {
  const cl_device_id device = program->devices[0]->handle;
  auto kernel = std::make_shared<Kernel>();
  kernel->name = kernel_name(handle);
  kernel->args = read_args(handle);
  kernel->required =
      group_value<std::array<std::size_t, 3>>(handle, device, CL_KERNEL_COMPILE_WORK_GROUP_SIZE);
  kernel->static_local = group_value<cl_ulong>(handle, device, CL_KERNEL_LOCAL_MEM_SIZE);
  kernel->group_limit = group_value<std::size_t>(handle, device, CL_KERNEL_WORK_GROUP_SIZE);
  if (program->from_container()) kernel->circuit = program->container->container.find(kernel->name);
  kernel->program = std::move(program);
  return kernel;
}

void register_kernel(cl_kernel handle, std::shared_ptr<Kernel> kernel) {
  const Lock lock(state().mutex);
  kernel->name_id = state().timeline->intern(kernel->name);
  state().kernels.add(handle, std::move(kernel));
}

cl_kernel CL_API_CALL create_kernel(cl_program program_handle, const char* name,
                                    cl_int* errcode_ret) {
  return guarded_object<cl_kernel>(errcode_ret, [&](cl_int& error) -> cl_kernel {
    auto program = find_program(program_handle);
    if (program && program->refused) {
      error = CL_INVALID_PROGRAM_EXECUTABLE;
      return nullptr;
    }
    if (program && name && program->from_container() && !program->container->container.find(name)) {
      error = CL_INVALID_KERNEL_NAME;
      return nullptr;
    }
    const cl_kernel kernel = target().clCreateKernel(program_handle, name, &error);
    if (kernel && program) register_kernel(kernel, describe(kernel, std::move(program)));
    return kernel;
  });
}

cl_int CL_API_CALL create_kernels_in_program(cl_program program_handle, cl_uint count,
                                             cl_kernel* kernels, cl_uint* count_ret) {
  return guarded([&]() -> cl_int {
    const auto program = find_program(program_handle);
    if (program && program->refused) return CL_INVALID_PROGRAM_EXECUTABLE;
    cl_uint made = 0;
    const cl_int error = target().clCreateKernelsInProgram(program_handle, count, kernels, &made);
    if (error == CL_SUCCESS && count_ret) *count_ret = made;
    for (cl_uint i = 0; error == CL_SUCCESS && program && kernels && i < made; ++i) {
      register_kernel(kernels[i], describe(kernels[i], program));
    }
    return error;
  });
}

cl_kernel CL_API_CALL clone_kernel(cl_kernel source, cl_int* errcode_ret) {
  return guarded_object<cl_kernel>(errcode_ret, [&](cl_int& error) -> cl_kernel {
    const cl_kernel clone = target().clCloneKernel(source, &error);
    if (!clone) return nullptr;
    const Lock lock(state().mutex);
    if (const auto original = state().kernels.find(source)) {
      state().kernels.add(clone, std::make_shared<Kernel>(*original));
    }
    return clone;
  });
}

/// Null is a buffer, a handle of another kind is none.
cl_int check_memory_arg(cl_kernel handle, cl_uint index, const void* value) {
  const Lock lock(state().mutex);
  const auto kernel = state().kernels.find(handle);
  if (!kernel || index >= kernel->args.size() || !kernel->args[index].buffer) return CL_SUCCESS;
  cl_mem memory = nullptr;
  std::memcpy(&memory, value, sizeof memory);
  return memory ? check_handle(memory) : CL_SUCCESS;
}

cl_int CL_API_CALL set_kernel_arg(cl_kernel handle, cl_uint index, std::size_t size,
                                  const void* value) {
  const bool could_be_buffer = value && size == sizeof(cl_mem);
  if (could_be_buffer) {
    const cl_int wrong = guarded([&] { return check_memory_arg(handle, index, value); });
    if (wrong != CL_SUCCESS) return wrong;
  }
  const cl_int error = target().clSetKernelArg(handle, index, size, value);
  if (error != CL_SUCCESS || (value && !could_be_buffer)) return error;
  return guarded([&]() -> cl_int {
    const Lock lock(state().mutex);
    const auto kernel = state().kernels.find(handle);
    if (!kernel || index >= kernel->args.size()) return CL_SUCCESS;
    KernelArg& arg = kernel->args[index];
    if (arg.local && !value) arg.local_bytes = size;
    if (arg.buffer) {
      arg.memory = nullptr;
      if (value) std::memcpy(&arg.memory, value, sizeof arg.memory);
    }
    return CL_SUCCESS;
  });
}

cl_int CL_API_CALL retain_kernel(cl_kernel handle) {
  return guarded([&]() -> cl_int {
    const cl_int error = target().clRetainKernel(handle);
    if (error == CL_SUCCESS) {
      const Lock lock(state().mutex);
      state().kernels.retain(handle);
    }
    return error;
  });
}

cl_int CL_API_CALL release_kernel(cl_kernel handle) {
  return guarded([&]() -> cl_int {
    {
      const Lock lock(state().mutex);
      state().kernels.release(handle);
    }
    return target().clReleaseKernel(handle);
  });
}

}  // namespace

void add_kernel_calls(cl_icd_dispatch& table) {
  table.clCreateKernel = create_kernel;
  table.clCreateKernelsInProgram = create_kernels_in_program;
  table.clCloneKernel = clone_kernel;
  table.clSetKernelArg = set_kernel_arg;
  table.clRetainKernel = retain_kernel;
  table.clReleaseKernel = release_kernel;
}

}  // namespace partita::layer
