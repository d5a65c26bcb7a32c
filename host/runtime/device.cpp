#include "host/runtime/device.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "devices/work.h"
#include "host/runtime/error.h"

namespace partita::runtime {
namespace {

/// A text query that only emulated devices answer; empty on others.
std::string optional_text(const cl::Device& device, cl_device_info what) {
  std::size_t size = 0;
  if (clGetDeviceInfo(device(), what, 0, nullptr, &size) != CL_SUCCESS || size == 0) return {};
  std::string text(size, '\0');
  if (clGetDeviceInfo(device(), what, size, text.data(), nullptr) != CL_SUCCESS) return {};
  text.resize(size - 1);
  return text;
}

Device describe(const cl::Platform& platform, const cl::Device& cl) {
  Device device;
  device.platform = platform;
  device.cl = cl;
  device.name = cl.getInfo<CL_DEVICE_NAME>();
  device.platform_name = platform.getInfo<CL_PLATFORM_NAME>();
  device.driver_version = cl.getInfo<CL_DRIVER_VERSION>();
  device.type = cl.getInfo<CL_DEVICE_TYPE>();
  device.accepts_source = cl.getInfo<CL_DEVICE_COMPILER_AVAILABLE>() != CL_FALSE;
  device.max_work_group = cl.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
  device.local_memory = cl.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
  device.global_memory = cl.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  const std::string extensions = cl.getInfo<CL_DEVICE_EXTENSIONS>();
  device.doubles = extensions.find("cl_khr_fp64") != std::string::npos;
  device.node = optional_text(cl, kDeviceNode);
  device.profile = optional_text(cl, kDeviceProfile);
  return device;
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return out;
}

}  // namespace

Variant Device::own_variant() const {
  if ((type & CL_DEVICE_TYPE_GPU) != 0) return Variant::gpu;
  if ((type & CL_DEVICE_TYPE_ACCELERATOR) != 0) return Variant::fpga;
  return Variant::cpu;
}

std::string_view kind_of(const Device& device) {
  return to_string(device.own_variant());
}

std::vector<Device> find_devices() {
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error& error) {
    throw DeviceError(
        fmt::format("no OpenCL platform found ({}): install a driver, for instance the "
                    "package pocl-opencl-icd",
                    error_name(error.err())));
  }
  std::vector<Device> devices;
  for (const cl::Platform& platform : platforms) {
    std::vector<cl::Device> found;
    try {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &found);
    } catch (const cl::Error&) {
      continue;  // a platform without devices is no error
    }
    for (const cl::Device& device : found) devices.push_back(describe(platform, device));
  }
  if (devices.empty()) throw DeviceError("no OpenCL device found on any platform");
  return devices;
}

Device select_device(const std::vector<Device>& devices, std::string_view what) {
  constexpr std::size_t kShortestPart = 3;  // shorter ones are in names by accident
  const std::string wanted = lower(what);
  const auto in_name = [&wanted](const Device& device) {
    return wanted.size() >= kShortestPart && lower(device.name).find(wanted) != std::string::npos;
  };
  for (const Device& device : devices) {
    if (kind_of(device) == wanted) return device;
  }
  for (const Device& device : devices) {
    if (in_name(device) || lower(device.profile) == wanted) return device;
  }
  std::string known;
  for (const Device& device : devices) {
    known += fmt::format("{}{} ({})", known.empty() ? "" : ", ", kind_of(device), device.name);
  }
  throw Error(fmt::format("device '{}' is not on this machine: it has {}", what, known));
}

std::string error_name(cl_int code) {
#define PARTITA_CASE(NAME) \
  case NAME:               \
    return #NAME
  switch (code) {
    PARTITA_CASE(CL_SUCCESS);
    PARTITA_CASE(CL_DEVICE_NOT_FOUND);
    PARTITA_CASE(CL_DEVICE_NOT_AVAILABLE);
    PARTITA_CASE(CL_COMPILER_NOT_AVAILABLE);
    PARTITA_CASE(CL_MEM_OBJECT_ALLOCATION_FAILURE);
    PARTITA_CASE(CL_OUT_OF_RESOURCES);
    PARTITA_CASE(CL_OUT_OF_HOST_MEMORY);
    PARTITA_CASE(CL_BUILD_PROGRAM_FAILURE);
    PARTITA_CASE(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST);
    PARTITA_CASE(CL_INVALID_VALUE);
    PARTITA_CASE(CL_INVALID_PLATFORM);
    PARTITA_CASE(CL_INVALID_DEVICE);
    PARTITA_CASE(CL_INVALID_CONTEXT);
    PARTITA_CASE(CL_INVALID_COMMAND_QUEUE);
    PARTITA_CASE(CL_INVALID_MEM_OBJECT);
    PARTITA_CASE(CL_INVALID_BINARY);
    PARTITA_CASE(CL_INVALID_BUILD_OPTIONS);
    PARTITA_CASE(CL_INVALID_PROGRAM);
    PARTITA_CASE(CL_INVALID_PROGRAM_EXECUTABLE);
    PARTITA_CASE(CL_INVALID_KERNEL_NAME);
    PARTITA_CASE(CL_INVALID_KERNEL);
    PARTITA_CASE(CL_INVALID_ARG_INDEX);
    PARTITA_CASE(CL_INVALID_ARG_SIZE);
    PARTITA_CASE(CL_INVALID_KERNEL_ARGS);
    PARTITA_CASE(CL_INVALID_WORK_DIMENSION);
    PARTITA_CASE(CL_INVALID_WORK_GROUP_SIZE);
    PARTITA_CASE(CL_INVALID_WORK_ITEM_SIZE);
    PARTITA_CASE(CL_INVALID_EVENT_WAIT_LIST);
    PARTITA_CASE(CL_INVALID_EVENT);
    PARTITA_CASE(CL_INVALID_OPERATION);
    PARTITA_CASE(CL_INVALID_BUFFER_SIZE);
    PARTITA_CASE(CL_PLATFORM_NOT_FOUND_KHR);
    default:
      return fmt::format("OpenCL error {}", code);
  }
#undef PARTITA_CASE
}

}  // namespace partita::runtime
