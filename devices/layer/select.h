// Devices by type, for clGetDeviceIDs and clCreateContextFromType.
#ifndef PARTITA_DEVICES_LAYER_SELECT_H
#define PARTITA_DEVICES_LAYER_SELECT_H

#include <vector>

#include "devices/layer/state.h"

namespace partita::layer {

bool valid_device_type(cl_device_type type);

/// In the machine's order; the first device of a platform is its default.
std::vector<Device*> select_devices(const Platform& platform, cl_device_type type);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_SELECT_H
