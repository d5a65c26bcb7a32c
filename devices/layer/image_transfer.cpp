// Commands on images: the same as on buffers, in pixels.
#include "devices/layer/calls.h"
#include "devices/layer/commands.h"
#include "devices/layer/memory.h"
#include "devices/layer/whole_device.h"

namespace partita::layer {

std::uint64_t image_bytes(cl_mem image, const std::size_t* region) {
  const auto memory = find_memory(image);
  const std::uint64_t pixel = memory ? memory->element_bytes : 1;
  return volume(region) * pixel;
}

namespace {

using timeline::CommandKind;

cl_int CL_API_CALL read_image(cl_command_queue queue, cl_mem image, cl_bool blocking,
                              const std::size_t* origin, const std::size_t* region, std::size_t row,
                              std::size_t slice, void* host, cl_uint wait_count,
                              const cl_event* waits, cl_event* event) {
  return enqueue_image({queue, wait_count, waits, event, blocking != CL_FALSE},
                       CL_COMMAND_READ_IMAGE, moved(CommandKind::read, image_bytes(image, region)),
                       [&](cl_command_queue q, cl_uint n, const cl_event* list, cl_event* e) {
                         return target().clEnqueueReadImage(q, image, CL_FALSE, origin, region, row,
                                                            slice, host, n, list, e);
                       });
}

cl_int CL_API_CALL write_image(cl_command_queue queue, cl_mem image, cl_bool blocking,
                               const std::size_t* origin, const std::size_t* region,
                               std::size_t row, std::size_t slice, const void* host,
                               cl_uint wait_count, const cl_event* waits, cl_event* event) {
  const MemoryUse uses[] = {{image, false, true}};
  return enqueue_image({queue, wait_count, waits, event, blocking != CL_FALSE, uses},
                       CL_COMMAND_WRITE_IMAGE,
                       moved(CommandKind::write, image_bytes(image, region)),
                       [&](cl_command_queue q, cl_uint n, const cl_event* list, cl_event* e) {
                         return target().clEnqueueWriteImage(q, image, CL_FALSE, origin, region,
                                                             row, slice, host, n, list, e);
                       });
}

cl_int CL_API_CALL copy_image(cl_command_queue queue, cl_mem from, cl_mem to,
                              const std::size_t* from_origin, const std::size_t* to_origin,
                              const std::size_t* region, cl_uint wait_count, const cl_event* waits,
                              cl_event* event) {
  const MemoryUse uses[] = {{from, true, false}, {to, false, true}};
  return enqueue_image({queue, wait_count, waits, event, false, uses}, CL_COMMAND_COPY_IMAGE,
                       inside(queue, CommandKind::copy, image_bytes(from, region)),
                       [&](cl_command_queue q, cl_uint n, const cl_event* list, cl_event* e) {
                         return target().clEnqueueCopyImage(q, from, to, from_origin, to_origin,
                                                            region, n, list, e);
                       });
}

cl_int CL_API_CALL copy_image_to_buffer(cl_command_queue queue, cl_mem from, cl_mem to,
                                        const std::size_t* origin, const std::size_t* region,
                                        std::size_t offset, cl_uint wait_count,
                                        const cl_event* waits, cl_event* event) {
  const MemoryUse uses[] = {{from, true, false}, {to, false, true}};
  return enqueue_image(
      {queue, wait_count, waits, event, false, uses}, CL_COMMAND_COPY_IMAGE_TO_BUFFER,
      inside(queue, CommandKind::copy, image_bytes(from, region)),
      [&](cl_command_queue q, cl_uint n, const cl_event* list, cl_event* e) {
        return target().clEnqueueCopyImageToBuffer(q, from, to, origin, region, offset, n, list, e);
      });
}

cl_int CL_API_CALL copy_buffer_to_image(cl_command_queue queue, cl_mem from, cl_mem to,
                                        std::size_t offset, const std::size_t* origin,
                                        const std::size_t* region, cl_uint wait_count,
                                        const cl_event* waits, cl_event* event) {
  const MemoryUse uses[] = {{from, true, false}, {to, false, true}};
  return enqueue_image(
      {queue, wait_count, waits, event, false, uses}, CL_COMMAND_COPY_BUFFER_TO_IMAGE,
      inside(queue, CommandKind::copy, image_bytes(to, region)),
      [&](cl_command_queue q, cl_uint n, const cl_event* list, cl_event* e) {
        return target().clEnqueueCopyBufferToImage(q, from, to, offset, origin, region, n, list, e);
      });
}

/// XRT has no clEnqueueFillImage.
cl_int CL_API_CALL fill_image(cl_command_queue handle, cl_mem image, const void* color,
                              const std::size_t* origin, const std::size_t* region,
                              cl_uint wait_count, const cl_event* waits, cl_event* event) {
  const auto queue = find_queue(handle);
  if (queue && queue->device->is_fpga()) return CL_INVALID_OPERATION;
  const MemoryUse uses[] = {{image, false, true}};
  return enqueue_image({handle, wait_count, waits, event, false, uses}, CL_COMMAND_FILL_IMAGE,
                       inside(handle, CommandKind::fill, image_bytes(image, region)),
                       [&](cl_command_queue q, cl_uint n, const cl_event* list, cl_event* e) {
                         return target().clEnqueueFillImage(q, image, color, origin, region, n,
                                                            list, e);
                       });
}

}  // namespace

void add_image_transfer_calls(cl_icd_dispatch& table) {
  table.clEnqueueReadImage = read_image;
  table.clEnqueueWriteImage = write_image;
  table.clEnqueueCopyImage = copy_image;
  table.clEnqueueCopyImageToBuffer = copy_image_to_buffer;
  table.clEnqueueCopyBufferToImage = copy_buffer_to_image;
  table.clEnqueueFillImage = fill_image;
}

}  // namespace partita::layer
