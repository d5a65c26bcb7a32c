// Creating programs from source and from binaries, and their reference counts.
#include "devices/layer/program.h"

#include <algorithm>

#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/program_binary.h"
#include "devices/layer/program_text.h"

namespace partita::layer {

std::shared_ptr<Program> find_program(cl_program handle) {
  const Lock lock(state().mutex);
  return state().programs.find(handle);
}

std::shared_ptr<Context> known_context(cl_context handle) {
  const Lock lock(state().mutex);
  return state().contexts.find(handle);
}

std::shared_ptr<Program> make_program(std::shared_ptr<Context> context) {
  auto program = std::make_shared<Program>();
  program->devices = context->devices;
  program->context = std::move(context);
  return program;
}

void register_program(cl_program handle, std::shared_ptr<Program> program) {
  const Lock lock(state().mutex);
  state().programs.add(handle, std::move(program));
}

cl_int check_device_list(const std::vector<Device*>& devices, cl_uint count,
                         const cl_device_id* list) {
  if ((count == 0) != (list == nullptr)) return CL_INVALID_VALUE;
  for (cl_uint i = 0; i < count; ++i) {
    const bool known = std::any_of(devices.begin(), devices.end(),
                                   [&](const Device* d) { return d->handle == list[i]; });
    if (!known) return CL_INVALID_DEVICE;
  }
  return CL_SUCCESS;
}

cl_program create_driver_program(cl_context context, const std::vector<Device*>& devices,
                                 const std::string& source, cl_int& error) {
  const std::string text = prelude(devices) + source;
  const char* strings[] = {text.data()};
  const std::size_t lengths[] = {text.size()};
  return target().clCreateProgramWithSource(context, 1, strings, lengths, &error);
}

namespace {

/// An FPGA's kernels are built by the vendor's tool chain, never at run time.
bool takes_source(const Context& context) {
  return state().allow_source || std::none_of(context.devices.begin(), context.devices.end(),
                                              [](const Device* d) { return d->is_fpga(); });
}

std::string concatenate(cl_uint count, const char* const* strings, const std::size_t* lengths) {
  std::string source;
  for (cl_uint i = 0; i < count; ++i) {
    if (lengths && lengths[i]) {
      source.append(strings[i], lengths[i]);
    } else {
      source.append(strings[i]);
    }
  }
  return source;
}

cl_program CL_API_CALL create_with_source(cl_context handle, cl_uint count, const char** strings,
                                          const std::size_t* lengths, cl_int* errcode_ret) {
  return guarded_object<cl_program>(errcode_ret, [&](cl_int& error) -> cl_program {
    auto context = known_context(handle);
    if (!context)
      return target().clCreateProgramWithSource(handle, count, strings, lengths, &error);
    if (count == 0 || !strings || std::find(strings, strings + count, nullptr) != strings + count) {
      error = CL_INVALID_VALUE;
      return nullptr;
    }
    if (!takes_source(*context)) {
      context->tell("the FPGA loads containers through clCreateProgramWithBinary, not source");
      error = CL_INVALID_OPERATION;
      return nullptr;
    }
    auto entry = make_program(context);
    entry->source = concatenate(count, strings, lengths);
    const cl_program program = create_driver_program(handle, entry->devices, entry->source, error);
    if (program) register_program(program, std::move(entry));
    return program;
  });
}

/// The driver has one binary for all sub-devices; each given binary must be of its device.
cl_program create_from_wrapped(cl_context handle, std::shared_ptr<Program> entry,
                               const std::vector<std::span<const std::byte>>& binaries,
                               cl_int* status, cl_int& error) {
  for (std::size_t i = 0; i < binaries.size(); ++i) {
    const auto wrapped = unwrap_binary(binaries[i]);
    const Device& device = *entry->devices[i];
    // What a program built from source on an FPGA, in a what-if run, is no xclbin.
    const bool loadable = !device.is_fpga() || state().allow_source;
    const bool fits = loadable && wrapped && wrapped->device == device.profile.id;
    if (status) status[i] = fits ? CL_SUCCESS : CL_INVALID_BINARY;
    if (!fits) error = CL_INVALID_BINARY;
    if (fits) entry->keeps_arg_info = wrapped->keeps_arg_info;
  }
  if (error != CL_SUCCESS) return nullptr;
  const auto payload = unwrap_binary(binaries[0])->payload;
  const auto* bytes = reinterpret_cast<const unsigned char*>(payload.data());
  const std::size_t size = payload.size();
  entry->loaded.assign(reinterpret_cast<const char*>(bytes), size);
  cl_int driver_status = CL_SUCCESS;
  const cl_program program = target().clCreateProgramWithBinary(
      handle, 1, &entry->devices[0]->handle, &size, &bytes, &driver_status, &error);
  if (program) register_program(program, std::move(entry));
  if (status && !program) std::fill(status, status + binaries.size(), driver_status);
  return program;
}

cl_int read_binaries(const Context& context, cl_uint count, const cl_device_id* list,
                     const std::size_t* lengths, const unsigned char** binaries, cl_int* status,
                     std::vector<std::span<const std::byte>>& result) {
  if (count == 0 || !list || !lengths || !binaries) return CL_INVALID_VALUE;
  if (check_device_list(context.devices, count, list) != CL_SUCCESS) return CL_INVALID_DEVICE;
  cl_int error = CL_SUCCESS;
  for (cl_uint i = 0; i < count; ++i) {
    const bool there = lengths[i] != 0 && binaries[i];
    if (status) status[i] = there ? CL_SUCCESS : CL_INVALID_VALUE;
    if (!there) error = CL_INVALID_VALUE;
    if (there) result.push_back(std::as_bytes(std::span(binaries[i], lengths[i])));
  }
  return error;
}

cl_program CL_API_CALL create_with_binary(cl_context handle, cl_uint count,
                                          const cl_device_id* list, const std::size_t* lengths,
                                          const unsigned char** binaries, cl_int* status,
                                          cl_int* errcode_ret) {
  return guarded_object<cl_program>(errcode_ret, [&](cl_int& error) -> cl_program {
    auto context = known_context(handle);
    if (!context) {
      error = CL_INVALID_CONTEXT;
      return nullptr;
    }
    std::vector<std::span<const std::byte>> bytes;
    error = read_binaries(*context, count, list, lengths, binaries, status, bytes);
    if (error != CL_SUCCESS) return nullptr;
    if (is_container(bytes[0])) {
      if (count == 1) {
        auto alone = std::make_shared<Context>(*context);
        alone->devices = {find_device(list[0])};
        const cl_program program = load_container(handle, std::move(alone), bytes[0], error);
        if (status && error == CL_INVALID_BINARY) status[0] = error;
        return program;
      }
      error = CL_INVALID_BINARY;
      return nullptr;
    }
    auto entry = make_program(std::move(context));
    entry->devices.clear();
    for (cl_uint i = 0; i < count; ++i) entry->devices.push_back(find_device(list[i]));
    return create_from_wrapped(handle, std::move(entry), bytes, status, error);
  });
}

/// No emulated runtime has an intermediate language or built-in kernels.
cl_program CL_API_CALL create_with_il(cl_context handle, const void*, std::size_t,
                                      cl_int* errcode_ret) {
  return guarded_object<cl_program>(errcode_ret, [&](cl_int& error) -> cl_program {
    error = known_context(handle) ? CL_INVALID_OPERATION : CL_INVALID_CONTEXT;
    return nullptr;
  });
}

cl_program CL_API_CALL create_with_built_in_kernels(cl_context handle, cl_uint count,
                                                    const cl_device_id* list, const char*,
                                                    cl_int* errcode_ret) {
  return guarded_object<cl_program>(errcode_ret, [&](cl_int& error) -> cl_program {
    const auto context = known_context(handle);
    error = !context ? CL_INVALID_CONTEXT
            : count && check_device_list(context->devices, count, list) == CL_INVALID_DEVICE
                ? CL_INVALID_DEVICE
                : CL_INVALID_VALUE;
    return nullptr;
  });
}

cl_int CL_API_CALL retain_program(cl_program handle) {
  return guarded([&]() -> cl_int {
    const cl_int error = target().clRetainProgram(handle);
    if (error == CL_SUCCESS) {
      const Lock lock(state().mutex);
      state().programs.retain(handle);
    }
    return error;
  });
}

cl_int CL_API_CALL release_program(cl_program handle) {
  return guarded([&]() -> cl_int {
    {
      const Lock lock(state().mutex);
      state().programs.release(handle);
    }
    return target().clReleaseProgram(handle);
  });
}

}  // namespace

void add_program_calls(cl_icd_dispatch& table) {
  table.clCreateProgramWithSource = create_with_source;
  table.clCreateProgramWithBinary = create_with_binary;
  table.clCreateProgramWithIL = create_with_il;
  table.clCreateProgramWithBuiltInKernels = create_with_built_in_kernels;
  table.clRetainProgram = retain_program;
  table.clReleaseProgram = release_program;
}

}  // namespace partita::layer
