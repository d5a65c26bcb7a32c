// clGetDeviceInfo's answers, from the profile alone.
#ifndef PARTITA_DEVICES_LAYER_DEVICE_INFO_H
#define PARTITA_DEVICES_LAYER_DEVICE_INFO_H

#include <vector>

#include "devices/layer/answer.h"
#include "devices/layer/state.h"

namespace partita::layer {

cl_int device_info(const Device& device, cl_device_info name, const Answer& answer);

/// Versions of OpenCL C that the device compiles, with their numbers: an OpenCL 3.0 device offers
/// 3.0 (without the optional features) beside those up to its CL_DEVICE_OPENCL_C_VERSION.
std::vector<cl_version> c_versions(const Device& device);

/// Names of the optional OpenCL C 3.0 features that the device has.
std::vector<std::string> c_features(const Device& device);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_DEVICE_INFO_H
