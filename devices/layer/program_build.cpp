// Building, compiling and linking. The driver is called without the program's callback, which runs
// at the end, in the calling thread, as OpenCL allows.
#include <algorithm>

#include "devices/layer/answer.h"
#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/handles.h"
#include "devices/layer/program.h"
#include "devices/layer/program_text.h"

namespace partita::layer {
namespace {

using BuildNotify = void(CL_CALLBACK*)(cl_program, void*);

/// A build that the layer refuses by itself, with its log; empty: the driver decides.
std::string refusal(const Program& program, const BuildOptions& options) {
  for (const Device* d : program.devices) {
    if (d->fault.lost()) return d->machine.name + ": injected fault: the device is lost\n";
    if (d->fault.build_fails()) return d->machine.name + ": injected fault: the build fails\n";
  }
  return options.refusal;
}

/// What building and compiling have in common; `run` is the driver's call.
template <typename Run>
cl_int build(Program& program, const char* given, cl_int refused_error, Run&& run) {
  const BuildOptions options = build_options(given, program.devices);
  const std::string refused = refusal(program, options);
  const cl_int error = refused.empty() ? run(options.text.c_str()) : refused_error;
  const Lock lock(state().mutex);
  program.options = given ? given : "";
  program.built = true;
  program.keeps_arg_info = options.keeps_arg_info;
  program.refused.reset();
  if (!refused.empty()) program.refused = RefusedBuild{refused};
  ++program.builds;
  return error;
}

cl_int CL_API_CALL build_program(cl_program handle, cl_uint count, const cl_device_id* list,
                                 const char* options, BuildNotify notify, void* user_data) {
  return guarded([&]() -> cl_int {
    const auto program = find_program(handle);
    if (!program) {
      return target().clBuildProgram(handle, count, list, options, notify, user_data);
    }
    if (!notify && user_data) return CL_INVALID_VALUE;
    cl_int error = check_device_list(program->devices, count, list);
    if (error != CL_SUCCESS) return error;
    if (program->from_container()) {  // it is hardware already
      const Lock lock(state().mutex);
      program->options = options ? options : "";
      program->built = true;
    } else {
      error = build(*program, options, CL_BUILD_PROGRAM_FAILURE, [&](const char* text) {
        return target().clBuildProgram(handle, 0, nullptr, text, nullptr, nullptr);
      });
    }
    if (notify) notify(handle, user_data);
    return error;
  });
}

/// Headers and their names come together, or not at all; PoCL would follow null.
cl_int check_headers(cl_uint count, const cl_program* headers, const char** names) {
  if (count == 0) return headers || names ? CL_INVALID_VALUE : CL_SUCCESS;
  if (!headers || !names || std::find(names, names + count, nullptr) != names + count) {
    return CL_INVALID_VALUE;
  }
  return valid_handles(count, headers) ? CL_SUCCESS : CL_INVALID_PROGRAM;
}

cl_int CL_API_CALL compile_program(cl_program handle, cl_uint count, const cl_device_id* list,
                                   const char* options, cl_uint headers, const cl_program* header,
                                   const char** names, BuildNotify notify, void* user_data) {
  return guarded([&]() -> cl_int {
    const auto program = find_program(handle);
    if (!program) {
      return target().clCompileProgram(handle, count, list, options, headers, header, names, notify,
                                       user_data);
    }
    if (!notify && user_data) return CL_INVALID_VALUE;
    cl_int error = check_device_list(program->devices, count, list);
    if (error == CL_SUCCESS) error = check_headers(headers, header, names);
    if (error != CL_SUCCESS) return error;
    if (program->from_container()) return CL_INVALID_OPERATION;
    error = build(*program, options, CL_COMPILE_PROGRAM_FAILURE, [&](const char* text) {
      return target().clCompileProgram(handle, 0, nullptr, text, headers, header, names, nullptr,
                                       nullptr);
    });
    if (notify) notify(handle, user_data);
    return error;
  });
}

/// The same code as a library, for estimates: the inputs may be gone when one is made.
std::shared_ptr<const std::string> library_of(cl_context context, cl_uint inputs,
                                              const cl_program* input) {
  return std::make_shared<const std::string>(twin_binary([&] {
    cl_int error = CL_SUCCESS;
    return target().clLinkProgram(context, 0, nullptr, "-create-library", inputs, input, nullptr,
                                  nullptr, &error);
  }));
}

cl_program CL_API_CALL link_program(cl_context handle, cl_uint count, const cl_device_id* list,
                                    const char* options, cl_uint inputs, const cl_program* input,
                                    BuildNotify notify, void* user_data, cl_int* errcode_ret) {
  return guarded_object<cl_program>(errcode_ret, [&](cl_int& error) -> cl_program {
    auto context = known_context(handle);
    if (!context) {
      error = CL_INVALID_CONTEXT;
      return nullptr;
    }
    error =
        !notify && user_data ? CL_INVALID_VALUE : check_device_list(context->devices, count, list);
    if (error == CL_SUCCESS && (inputs == 0 || !input)) error = CL_INVALID_VALUE;
    if (error == CL_SUCCESS && !valid_handles(inputs, input)) error = CL_INVALID_PROGRAM;
    if (error != CL_SUCCESS) return nullptr;
    auto entry = make_program(std::move(context));
    if (count) entry->devices.clear();
    for (cl_uint i = 0; i < count; ++i) entry->devices.push_back(find_device(list[i]));
    const std::string refused = refusal(*entry, {});
    if (!refused.empty()) {
      error = CL_LINK_PROGRAM_FAILURE;
      return nullptr;
    }
    entry->options = options ? options : "";
    entry->built = true;
    for (cl_uint i = 0; i < inputs; ++i) {
      const auto part = find_program(input[i]);
      entry->keeps_arg_info = entry->keeps_arg_info || (part && part->keeps_arg_info);
    }
    const cl_program program = target().clLinkProgram(handle, 0, nullptr, options, inputs, input,
                                                      nullptr, nullptr, &error);
    if (program && error == CL_SUCCESS) entry->unlinked = library_of(handle, inputs, input);
    if (program) register_program(program, std::move(entry));
    if (program && notify) notify(program, user_data);
    return program;
  });
}

cl_int CL_API_CALL get_build_info(cl_program handle, cl_device_id device,
                                  cl_program_build_info name, std::size_t size, void* value,
                                  std::size_t* size_ret) {
  return guarded([&]() -> cl_int {
    const auto program = find_program(handle);
    if (!program) {
      return target().clGetProgramBuildInfo(handle, device, name, size, value, size_ret);
    }
    if (check_device_list(program->devices, 1, &device) != CL_SUCCESS) return CL_INVALID_DEVICE;
    const Answer answer(size, value, size_ret);
    {
      const Lock lock(state().mutex);
      if (name == CL_PROGRAM_BUILD_OPTIONS) return answer.put_text(program->options);
      if (program->refused && name == CL_PROGRAM_BUILD_STATUS) {
        return answer.put<cl_build_status>(CL_BUILD_ERROR);
      }
      if (program->refused && name == CL_PROGRAM_BUILD_LOG) {
        return answer.put_text(program->refused->log);
      }
      if (program->refused && name == CL_PROGRAM_BINARY_TYPE) {
        return answer.put<cl_program_binary_type>(CL_PROGRAM_BINARY_TYPE_NONE);
      }
    }
    return target().clGetProgramBuildInfo(handle, device, name, size, value, size_ret);
  });
}

}  // namespace

void add_program_build_calls(cl_icd_dispatch& table) {
  table.clBuildProgram = build_program;
  table.clCompileProgram = compile_program;
  table.clLinkProgram = link_program;
  table.clGetProgramBuildInfo = get_build_info;
}

}  // namespace partita::layer
