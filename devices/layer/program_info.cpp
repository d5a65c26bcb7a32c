// clGetProgramInfo: devices, source and binaries as the program knows them.
#include <cstring>

#include "devices/layer/answer.h"
#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/program.h"
#include "devices/layer/program_binary.h"

namespace partita::layer {

std::string driver_binary(cl_program handle) {
  std::size_t bytes = 0;
  if (target().clGetProgramInfo(handle, CL_PROGRAM_BINARY_SIZES, 0, nullptr, &bytes) !=
      CL_SUCCESS) {
    return {};
  }
  std::vector<std::size_t> sizes(bytes / sizeof(std::size_t));
  if (sizes.empty() || target().clGetProgramInfo(handle, CL_PROGRAM_BINARY_SIZES, bytes,
                                                 sizes.data(), nullptr) != CL_SUCCESS) {
    return {};
  }
  std::string binary(sizes[0], '\0');
  std::vector<char*> pointers(sizes.size(), nullptr);
  pointers[0] = binary.data();
  if (binary.empty() ||
      target().clGetProgramInfo(handle, CL_PROGRAM_BINARIES, pointers.size() * sizeof(char*),
                                pointers.data(), nullptr) != CL_SUCCESS) {
    return {};
  }
  return binary;
}

std::string twin_binary(const std::function<cl_program()>& make) {
  static std::mutex mutex;
  const Lock lock(mutex);
  const cl_program twin = make();
  if (!twin) return {};
  std::string binary = driver_binary(twin);
  target().clReleaseProgram(twin);
  return binary;
}

namespace {

/// One binary for each of the program's devices.
std::vector<std::string> binaries(cl_program handle, const Program& program) {
  std::vector<std::string> list;
  if (program.from_container()) {
    list.assign(program.devices.size(), program.container_bytes);
    return list;
  }
  std::string payload = program.refused ? std::string() : driver_binary(handle);
  if (payload.empty() && !program.refused) payload = program.loaded;
  for (const Device* d : program.devices) {
    list.push_back(payload.empty()
                       ? std::string()
                       : wrap_binary({d->profile.id, program.keeps_arg_info,
                                      std::as_bytes(std::span(payload.data(), payload.size()))}));
  }
  return list;
}

cl_int put_binary_sizes(const std::vector<std::string>& list, const Answer& answer) {
  std::vector<std::size_t> sizes;
  for (const std::string& b : list) sizes.push_back(b.size());
  return answer.put_list(sizes);
}

cl_int put_binaries(const std::vector<std::string>& list, const Answer& answer) {
  const std::size_t bytes = list.size() * sizeof(char*);
  if (answer.value() && answer.size() < bytes) return CL_INVALID_VALUE;
  auto** pointers = static_cast<char**>(answer.value());
  for (std::size_t i = 0; pointers && i < list.size(); ++i) {
    if (pointers[i]) std::memcpy(pointers[i], list[i].data(), list[i].size());
  }
  if (answer.size_ret()) *answer.size_ret() = bytes;
  return CL_SUCCESS;
}

cl_int CL_API_CALL get_program_info(cl_program handle, cl_program_info name, std::size_t size,
                                    void* value, std::size_t* size_ret) {
  return guarded([&]() -> cl_int {
    const auto program = find_program(handle);
    if (!program) return target().clGetProgramInfo(handle, name, size, value, size_ret);
    const Answer answer(size, value, size_ret);
    switch (name) {
      case CL_PROGRAM_NUM_DEVICES:
        return answer.put(static_cast<cl_uint>(program->devices.size()));
      case CL_PROGRAM_DEVICES: {
        std::vector<cl_device_id> devices;
        for (const Device* d : program->devices) devices.push_back(d->handle);
        return answer.put_list(devices);
      }
      case CL_PROGRAM_SOURCE:  // an xclbin gives none
        return answer.put_text(program->source);
      case CL_PROGRAM_BINARY_SIZES:
        return put_binary_sizes(binaries(handle, *program), answer);
      case CL_PROGRAM_BINARIES:
        return put_binaries(binaries(handle, *program), answer);
      case CL_PROGRAM_NUM_KERNELS:
      case CL_PROGRAM_KERNEL_NAMES:
        if (program->refused) return CL_INVALID_PROGRAM_EXECUTABLE;
        [[fallthrough]];
      default:
        return target().clGetProgramInfo(handle, name, size, value, size_ret);
    }
  });
}

}  // namespace

void add_program_info_calls(cl_icd_dispatch& table) {
  table.clGetProgramInfo = get_program_info;
}

}  // namespace partita::layer
