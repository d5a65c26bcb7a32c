// Devices are found by what they can do, never by a version string: a Xilinx card calls itself
// "OpenCL 1.0" and does what we need; a host that asks for 1.2 refuses it.
#ifndef PARTITA_HOST_RUNTIME_DEVICE_H
#define PARTITA_HOST_RUNTIME_DEVICE_H

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <CL/opencl.hpp>

#include "host/runtime/kernel_spec.h"

namespace partita::runtime {

struct Device {
  cl::Platform platform;
  cl::Device cl;
  std::string name;
  std::string platform_name;
  std::string driver_version;
  std::string node;     ///< node of the emulated machine; empty on a real device
  std::string profile;  ///< profile it is emulated from; empty on a real device
  cl_device_type type = 0;
  bool accepts_source = true;  ///< has an online compiler; else it takes containers (xclbin)
  std::size_t max_work_group = 0;
  std::size_t local_memory = 0;
  std::size_t global_memory = 0;
  bool doubles = false;

  bool emulated() const { return !profile.empty(); }
  /// The variant written for this kind of device.
  Variant own_variant() const;
};

/// "cpu", "gpu", "fpga" for the device's type.
std::string_view kind_of(const Device& device);

/// All devices of all platforms, in the platforms' order. Throws Error if there is no platform.
std::vector<Device> find_devices();

/// The first device of kind "cpu", "gpu" or "fpga", or the first with the profile `what` or with
/// `what`, of at least three characters, in its name (case-insensitive). Throws Error that lists
/// what there is.
Device select_device(const std::vector<Device>& devices, std::string_view what);

/// "CL_OUT_OF_RESOURCES" and so on; the number for unknown codes.
std::string error_name(cl_int code);

}  // namespace partita::runtime

#endif  // PARTITA_HOST_RUNTIME_DEVICE_H
