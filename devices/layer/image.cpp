// Images: refused where no device of the context has images, limited elsewhere.
#include <algorithm>

#include "devices/layer/answer.h"
#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/memory.h"
#include "devices/layer/program.h"

namespace partita::layer {

bool has_images(const Context& context) {
  return std::any_of(context.devices.begin(), context.devices.end(),
                     [](const Device* d) { return d->cl.image_support; });
}

namespace {

bool within_limits(const Device& d, const cl_image_desc& desc) {
  switch (desc.image_type) {
    case CL_MEM_OBJECT_IMAGE1D:
    case CL_MEM_OBJECT_IMAGE1D_ARRAY:
      return desc.image_width <= d.cl.image2d_max[0];
    case CL_MEM_OBJECT_IMAGE1D_BUFFER:
      return desc.image_width <= d.cl.image_max_buffer_size;
    case CL_MEM_OBJECT_IMAGE2D:
    case CL_MEM_OBJECT_IMAGE2D_ARRAY:
      return desc.image_width <= d.cl.image2d_max[0] && desc.image_height <= d.cl.image2d_max[1];
    case CL_MEM_OBJECT_IMAGE3D:
      return desc.image_width <= d.cl.image3d_max[0] && desc.image_height <= d.cl.image3d_max[1] &&
             desc.image_depth <= d.cl.image3d_max[2];
    default:
      return true;  // the driver refuses it
  }
}

bool fits_somewhere(const Context& context, const cl_image_desc& desc) {
  return std::any_of(context.devices.begin(), context.devices.end(), [&](const Device* d) {
    return d->cl.image_support && within_limits(*d, desc);
  });
}

std::size_t query(cl_mem image, cl_image_info name) {
  std::size_t value = 1;
  target().clGetImageInfo(image, name, sizeof value, &value, nullptr);
  return value;
}

std::size_t memory_size(cl_mem image) {
  std::size_t value = 0;
  target().clGetMemObjectInfo(image, CL_MEM_SIZE, sizeof value, &value, nullptr);
  return value;
}

/// The size of an image is the driver's to say, so it is charged after it is made.
cl_mem adopt(cl_mem image, std::shared_ptr<Context> context, cl_mem made_from, cl_int& error) {
  std::shared_ptr<Memory> memory;
  if (made_from) {
    memory = std::make_shared<Memory>();
    memory->bytes = memory_size(image);
    memory->context = std::move(context);
    memory->parent = find_memory(made_from);
  } else {
    memory = reserve(std::move(context), memory_size(image), error);
    if (!memory) {
      target().clReleaseMemObject(image);
      return nullptr;
    }
  }
  memory->element_bytes = query(image, CL_IMAGE_ELEMENT_SIZE);
  register_memory(image, std::move(memory));
  return image;
}

template <typename Create>
cl_mem create(cl_context handle, const cl_image_desc* desc, cl_int& error, Create&& driver_create) {
  auto context = known_context(handle);
  if (!context) return driver_create(error);
  if (!has_images(*context)) {
    error = CL_INVALID_OPERATION;
    return nullptr;
  }
  if (desc && !fits_somewhere(*context, *desc)) {
    error = CL_INVALID_IMAGE_SIZE;
    return nullptr;
  }
  const cl_mem image = driver_create(error);
  if (!image) return nullptr;
  return adopt(image, std::move(context), desc ? desc->mem_object : nullptr, error);
}

cl_mem CL_API_CALL create_image(cl_context context, cl_mem_flags flags,
                                const cl_image_format* format, const cl_image_desc* desc,
                                void* host, cl_int* errcode_ret) {
  return guarded_object<cl_mem>(errcode_ret, [&](cl_int& error) {
    return create(context, desc, error, [&](cl_int& e) {
      return target().clCreateImage(context, flags, format, desc, host, &e);
    });
  });
}

cl_mem CL_API_CALL create_image_with_properties(cl_context context,
                                                const cl_mem_properties* properties,
                                                cl_mem_flags flags, const cl_image_format* format,
                                                const cl_image_desc* desc, void* host,
                                                cl_int* errcode_ret) {
  return guarded_object<cl_mem>(errcode_ret, [&](cl_int& error) {
    return create(context, desc, error, [&](cl_int& e) {
      return target().clCreateImageWithProperties(context, properties, flags, format, desc, host,
                                                  &e);
    });
  });
}

cl_mem CL_API_CALL create_image_2d(cl_context context, cl_mem_flags flags,
                                   const cl_image_format* format, std::size_t width,
                                   std::size_t height, std::size_t pitch, void* host,
                                   cl_int* errcode_ret) {
  cl_image_desc desc{};
  desc.image_type = CL_MEM_OBJECT_IMAGE2D;
  desc.image_width = width;
  desc.image_height = height;
  desc.image_row_pitch = pitch;
  return create_image(context, flags, format, &desc, host, errcode_ret);
}

cl_mem CL_API_CALL create_image_3d(cl_context context, cl_mem_flags flags,
                                   const cl_image_format* format, std::size_t width,
                                   std::size_t height, std::size_t depth, std::size_t row_pitch,
                                   std::size_t slice_pitch, void* host, cl_int* errcode_ret) {
  cl_image_desc desc{};
  desc.image_type = CL_MEM_OBJECT_IMAGE3D;
  desc.image_width = width;
  desc.image_height = height;
  desc.image_depth = depth;
  desc.image_row_pitch = row_pitch;
  desc.image_slice_pitch = slice_pitch;
  return create_image(context, flags, format, &desc, host, errcode_ret);
}

cl_int CL_API_CALL get_supported_formats(cl_context handle, cl_mem_flags flags,
                                         cl_mem_object_type type, cl_uint count,
                                         cl_image_format* formats, cl_uint* count_ret) {
  return guarded([&]() -> cl_int {
    const auto context = known_context(handle);
    // No device reads and writes an image in one kernel (CL_DEVICE_MAX_READ_WRITE_IMAGE_ARGS is 0).
    const bool none = context && (!has_images(*context) || flags == CL_MEM_KERNEL_READ_AND_WRITE);
    if (!none) {
      return target().clGetSupportedImageFormats(handle, flags, type, count, formats, count_ret);
    }
    if (formats && count == 0) return CL_INVALID_VALUE;
    if (count_ret) *count_ret = 0;
    return CL_SUCCESS;
  });
}

}  // namespace

void add_image_calls(cl_icd_dispatch& table) {
  table.clCreateImage = create_image;
  table.clCreateImageWithProperties = create_image_with_properties;
  table.clCreateImage2D = create_image_2d;
  table.clCreateImage3D = create_image_3d;
  table.clGetSupportedImageFormats = get_supported_formats;
}

}  // namespace partita::layer
