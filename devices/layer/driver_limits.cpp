#include "devices/layer/driver_limits.h"

#include <algorithm>

namespace partita::layer {
namespace {

/// 0 if the driver does not say.
template <typename T>
T ask(cl_device_id device, cl_device_info name) {
  T value{};
  target().clGetDeviceInfo(device, name, sizeof value, &value, nullptr);
  return value;
}

void lower(std::uint64_t& limit, std::uint64_t driver) {
  if (driver != 0) limit = std::min(limit, driver);
}

void clamp(profile::OpenclIdentity& cl, cl_device_id d) {
  lower(cl.max_work_group_size, ask<std::size_t>(d, CL_DEVICE_MAX_WORK_GROUP_SIZE));
  const auto items = ask<std::array<std::size_t, 3>>(d, CL_DEVICE_MAX_WORK_ITEM_SIZES);
  for (std::size_t i = 0; i < 3; ++i) lower(cl.max_work_item_sizes[i], items[i]);
  lower(cl.max_mem_alloc_size, ask<cl_ulong>(d, CL_DEVICE_MAX_MEM_ALLOC_SIZE));
  lower(cl.max_parameter_size, ask<std::size_t>(d, CL_DEVICE_MAX_PARAMETER_SIZE));
  lower(cl.max_read_image_args, ask<cl_uint>(d, CL_DEVICE_MAX_READ_IMAGE_ARGS));
  lower(cl.max_write_image_args, ask<cl_uint>(d, CL_DEVICE_MAX_WRITE_IMAGE_ARGS));
  lower(cl.max_samplers, ask<cl_uint>(d, CL_DEVICE_MAX_SAMPLERS));
  lower(cl.image2d_max[0], ask<std::size_t>(d, CL_DEVICE_IMAGE2D_MAX_WIDTH));
  lower(cl.image2d_max[1], ask<std::size_t>(d, CL_DEVICE_IMAGE2D_MAX_HEIGHT));
  lower(cl.image3d_max[0], ask<std::size_t>(d, CL_DEVICE_IMAGE3D_MAX_WIDTH));
  lower(cl.image3d_max[1], ask<std::size_t>(d, CL_DEVICE_IMAGE3D_MAX_HEIGHT));
  lower(cl.image3d_max[2], ask<std::size_t>(d, CL_DEVICE_IMAGE3D_MAX_DEPTH));
  lower(cl.image_max_buffer_size, ask<std::size_t>(d, CL_DEVICE_IMAGE_MAX_BUFFER_SIZE));
  lower(cl.image_max_array_size, ask<std::size_t>(d, CL_DEVICE_IMAGE_MAX_ARRAY_SIZE));
}

}  // namespace

void clamp_to_driver(State& state) {
  for (profile::MachineDevice& device : state.machine.devices) {
    clamp(device.profile.opencl, state.real_device);
  }
}

}  // namespace partita::layer
