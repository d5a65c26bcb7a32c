// The calls about devices that are not queries: finding them; there are no sub-devices.
#include "devices/layer/answer.h"
#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/device_info.h"
#include "devices/layer/select.h"

namespace partita::layer {

bool valid_device_type(cl_device_type type) {
  constexpr cl_device_type kKnown = CL_DEVICE_TYPE_DEFAULT | CL_DEVICE_TYPE_CPU |
                                    CL_DEVICE_TYPE_GPU | CL_DEVICE_TYPE_ACCELERATOR |
                                    CL_DEVICE_TYPE_CUSTOM;
  return type == CL_DEVICE_TYPE_ALL || (type != 0 && (type & ~kKnown) == 0);
}

std::vector<Device*> select_devices(const Platform& platform, cl_device_type type) {
  std::vector<Device*> selected;
  for (std::size_t i = 0; i < platform.devices.size(); ++i) {
    Device* device = platform.devices[i];
    const bool is_default = i == 0 && (type & CL_DEVICE_TYPE_DEFAULT) != 0;
    if (is_default || (type & profile::cl_type(device->profile.type)) != 0) {
      selected.push_back(device);
    }
  }
  return selected;
}

namespace {

cl_int CL_API_CALL get_device_ids(cl_platform_id handle, cl_device_type type, cl_uint num_entries,
                                  cl_device_id* devices, cl_uint* num_devices) {
  return guarded([&]() -> cl_int {
    if (!open_machine()) return CL_INVALID_PLATFORM;
    const Platform* platform = handle ? find_platform(handle) : state().platforms[0].get();
    if (!platform) return CL_INVALID_PLATFORM;
    if (!valid_device_type(type)) return CL_INVALID_DEVICE_TYPE;
    if ((devices && num_entries == 0) || (!devices && !num_devices)) return CL_INVALID_VALUE;
    const std::vector<Device*> selected = select_devices(*platform, type);
    if (num_devices) *num_devices = static_cast<cl_uint>(selected.size());
    if (selected.empty()) return CL_DEVICE_NOT_FOUND;
    for (std::size_t i = 0; devices && i < num_entries && i < selected.size(); ++i) {
      devices[i] = selected[i]->handle;
    }
    return CL_SUCCESS;
  });
}

cl_int CL_API_CALL get_device_info(cl_device_id handle, cl_device_info name, std::size_t size,
                                   void* value, std::size_t* size_ret) {
  return guarded([&]() -> cl_int {
    const Device* device = find_device(handle);
    if (!device) return CL_INVALID_DEVICE;
    return device_info(*device, name, Answer(size, value, size_ret));
  });
}

/// No emulated runtime offers sub-devices.
cl_int CL_API_CALL create_sub_devices(cl_device_id handle, const cl_device_partition_property*,
                                      cl_uint, cl_device_id*, cl_uint*) {
  return guarded([&]() -> cl_int {
    if (!find_device(handle)) return CL_INVALID_DEVICE;
    return CL_INVALID_VALUE;
  });
}

/// Root devices are not counted: retaining and releasing them does nothing.
cl_int CL_API_CALL keep_device(cl_device_id handle) {
  return guarded([&]() -> cl_int { return find_device(handle) ? CL_SUCCESS : CL_INVALID_DEVICE; });
}

/// The platforms report a host timer resolution of 0, which means that they have none.
cl_int CL_API_CALL get_device_and_host_timer(cl_device_id handle, cl_ulong*, cl_ulong*) {
  return guarded(
      [&]() -> cl_int { return find_device(handle) ? CL_INVALID_OPERATION : CL_INVALID_DEVICE; });
}

cl_int CL_API_CALL get_host_timer(cl_device_id handle, cl_ulong*) {
  return get_device_and_host_timer(handle, nullptr, nullptr);
}

}  // namespace

void add_device_calls(cl_icd_dispatch& table) {
  table.clGetDeviceIDs = get_device_ids;
  table.clGetDeviceInfo = get_device_info;
  table.clCreateSubDevices = create_sub_devices;
  table.clRetainDevice = keep_device;
  table.clReleaseDevice = keep_device;
  table.clGetDeviceAndHostTimer = get_device_and_host_timer;
  table.clGetHostTimer = get_host_timer;
}

}  // namespace partita::layer
