#include "host/runtime/kernel.h"

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::runtime {

void Kernel::check_count(std::size_t count) const {
  if (count == spec_->args.size()) return;
  throw Error(fmt::format("kernel {} takes {} arguments, {} were given", spec_->name,
                          spec_->args.size(), count));
}

void Kernel::check_scalar(cl_uint index, std::size_t size) const {
  const ArgSpec& arg = spec_->args[index];
  if (arg.access == Access::scalar && size_of(arg.type) == size) return;
  throw Error(fmt::format("kernel {}: argument {} '{}' is a {} {}, a number of {} bytes was given",
                          spec_->name, index, arg.name, to_string(arg.type),
                          arg.access == Access::scalar ? "scalar" : "array", size));
}

void Kernel::set_raw(cl_uint index, std::size_t size, const void* value) {
  const cl_int code = clSetKernelArg(kernel_(), index, size, value);
  if (code == CL_SUCCESS) return;
  throw DeviceError(fmt::format("kernel {}: argument {} '{}' refused ({})", spec_->name, index,
                                spec_->args[index].name, error_name(code)));
}

void Kernel::enqueue(const Shape& shape) {
  if (session_->extension().present()) {
    session_->extension().set_work(session_->queue(),
                                   spec_->declared_work(session_->charged(), shape));
  }
  const LaunchGeometry geometry = spec_->geometry(session_->executed(), shape);
  const cl_int code =
      clEnqueueNDRangeKernel(session_->queue()(), kernel_(), 3, nullptr, geometry.global.data(),
                             geometry.local.data(), 0, nullptr, nullptr);
  if (code == CL_SUCCESS) return;
  throw DeviceError(fmt::format("kernel {} on {}: launch for {} refused ({})", spec_->name,
                                session_->device().name, shape.to_string(), error_name(code)));
}

}  // namespace partita::runtime
