#include "devices/layer/handles.h"

#include <tuple>
#include <type_traits>

#include "devices/layer/call.h"

namespace partita::layer {
namespace {

/// Whether any table has a handle at this address.
bool known(void* address) {
  State& s = state();
  return s.contexts.has(static_cast<cl_context>(address)) ||
         s.queues.has(static_cast<cl_command_queue>(address)) ||
         s.memories.has(static_cast<cl_mem>(address)) ||
         s.samplers.has(static_cast<cl_sampler>(address)) ||
         s.programs.has(static_cast<cl_program>(address)) ||
         s.kernels.has(static_cast<cl_kernel>(address)) ||
         s.events.contains(static_cast<cl_event>(address)) ||
         std::any_of(s.devices.begin(), s.devices.end(),
                     [&](const auto& d) { return d->handle == address; }) ||
         std::any_of(s.platforms.begin(), s.platforms.end(),
                     [&](const auto& p) { return p.get() == address; });
}

cl_int judge(bool its_kind, void* address, cl_int error) {
  return its_kind || (address && !known(address)) ? CL_SUCCESS : error;
}

/// Arguments that are no handles are right; devices and platforms are found by their entry points.
template <typename Argument>
cl_int check(Argument argument) {
  if constexpr (requires { layer::check_handle(argument); }) {
    return layer::check_handle(argument);
  } else {
    return CL_SUCCESS;
  }
}

template <typename... Arguments>
cl_int first_error(Arguments... arguments) {
  const Lock lock(state().mutex);
  cl_int error = CL_SUCCESS;
  ((error = error == CL_SUCCESS ? check(arguments) : error), ...);
  return error;
}

/// An entry point that returns a handle has the error code's address as its last argument.
template <typename Result, typename... Arguments>
Result refuse(cl_int error, Arguments... arguments) {
  if constexpr (std::is_same_v<Result, cl_int>) {
    return error;
  } else {
    cl_int* const errcode_ret = std::get<sizeof...(arguments) - 1>(std::tie(arguments...));
    if (errcode_ret) *errcode_ret = error;
    return nullptr;
  }
}

template <auto Entry>
struct Guard;
template <typename Result, typename... Arguments,
          Result (CL_API_CALL* cl_icd_dispatch::*Entry)(Arguments...)>
struct Guard<Entry> {
  static inline Result(CL_API_CALL* inner)(Arguments...) = nullptr;

  static Result CL_API_CALL call(Arguments... arguments) {
    const cl_int error = guarded([&] { return first_error(arguments...); });
    return error == CL_SUCCESS ? inner(arguments...) : refuse<Result>(error, arguments...);
  }
  static void put(cl_icd_dispatch& table) {
    if (!(table.*Entry)) return;
    inner = table.*Entry;
    table.*Entry = call;
  }
};

template <auto... Entries>
void guard(cl_icd_dispatch& table) {
  (Guard<Entries>::put(table), ...);
}

using T = cl_icd_dispatch;

void guard_contexts(T& t) {
  guard<&T::clRetainContext, &T::clReleaseContext, &T::clGetContextInfo,
        &T::clSetContextDestructorCallback, &T::clCreateBuffer, &T::clCreateBufferWithProperties,
        &T::clCreateImage, &T::clCreateImageWithProperties, &T::clCreateImage2D,
        &T::clCreateImage3D, &T::clCreatePipe, &T::clGetSupportedImageFormats, &T::clCreateSampler,
        &T::clCreateSamplerWithProperties, &T::clCreateProgramWithSource,
        &T::clCreateProgramWithBinary, &T::clCreateProgramWithIL,
        &T::clCreateProgramWithBuiltInKernels, &T::clLinkProgram, &T::clCreateUserEvent>(t);
}

void guard_objects(T& t) {
  guard<&T::clRetainCommandQueue, &T::clReleaseCommandQueue, &T::clGetCommandQueueInfo, &T::clFlush,
        &T::clFinish, &T::clRetainMemObject, &T::clReleaseMemObject, &T::clGetMemObjectInfo,
        &T::clGetImageInfo, &T::clGetPipeInfo, &T::clCreateSubBuffer,
        &T::clSetMemObjectDestructorCallback, &T::clRetainSampler, &T::clReleaseSampler,
        &T::clGetSamplerInfo, &T::clRetainEvent, &T::clReleaseEvent, &T::clGetEventInfo,
        &T::clGetEventProfilingInfo, &T::clSetUserEventStatus, &T::clSetEventCallback>(t);
}

void guard_programs(T& t) {
  guard<&T::clRetainProgram, &T::clReleaseProgram, &T::clBuildProgram, &T::clCompileProgram,
        &T::clGetProgramInfo, &T::clGetProgramBuildInfo, &T::clSetProgramReleaseCallback,
        &T::clSetProgramSpecializationConstant, &T::clCreateKernel, &T::clCreateKernelsInProgram,
        &T::clRetainKernel, &T::clReleaseKernel, &T::clCloneKernel, &T::clSetKernelArg,
        &T::clSetKernelArgSVMPointer, &T::clSetKernelExecInfo, &T::clGetKernelInfo,
        &T::clGetKernelArgInfo, &T::clGetKernelWorkGroupInfo, &T::clGetKernelSubGroupInfo>(t);
}

/// Those with memory objects; launches, markers and barriers find queue and kernel themselves.
void guard_commands(T& t) {
  guard<&T::clEnqueueReadBuffer, &T::clEnqueueWriteBuffer, &T::clEnqueueReadBufferRect,
        &T::clEnqueueWriteBufferRect, &T::clEnqueueCopyBuffer, &T::clEnqueueCopyBufferRect,
        &T::clEnqueueFillBuffer, &T::clEnqueueReadImage, &T::clEnqueueWriteImage,
        &T::clEnqueueCopyImage, &T::clEnqueueCopyImageToBuffer, &T::clEnqueueCopyBufferToImage,
        &T::clEnqueueFillImage, &T::clEnqueueMapBuffer, &T::clEnqueueMapImage,
        &T::clEnqueueUnmapMemObject, &T::clEnqueueSVMFree, &T::clEnqueueSVMMemcpy,
        &T::clEnqueueSVMMemFill, &T::clEnqueueSVMMap, &T::clEnqueueSVMUnmap,
        &T::clEnqueueSVMMigrateMem>(t);
}

}  // namespace

cl_int check_handle(cl_context handle) {
  return judge(state().contexts.has(handle), handle, CL_INVALID_CONTEXT);
}
cl_int check_handle(cl_command_queue handle) {
  return judge(state().queues.has(handle), handle, CL_INVALID_COMMAND_QUEUE);
}
cl_int check_handle(cl_mem handle) {
  return judge(state().memories.has(handle), handle, CL_INVALID_MEM_OBJECT);
}
cl_int check_handle(cl_sampler handle) {
  return judge(state().samplers.has(handle), handle, CL_INVALID_SAMPLER);
}
cl_int check_handle(cl_program handle) {
  return judge(state().programs.has(handle), handle, CL_INVALID_PROGRAM);
}
cl_int check_handle(cl_kernel handle) {
  return judge(state().kernels.has(handle), handle, CL_INVALID_KERNEL);
}
cl_int check_handle(cl_event handle) {
  return judge(state().events.contains(handle), handle, CL_INVALID_EVENT);
}

void guard_handles(cl_icd_dispatch& table) {
  guard_contexts(table);
  guard_objects(table);
  guard_programs(table);
  guard_commands(table);
}

}  // namespace partita::layer
