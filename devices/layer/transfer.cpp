// Reading and writing buffers: bytes over the device's link.
#include "devices/layer/calls.h"
#include "devices/layer/commands.h"

namespace partita::layer {
namespace {

cl_int CL_API_CALL read_buffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
                               std::size_t offset, std::size_t bytes, void* host,
                               cl_uint wait_count, const cl_event* waits, cl_event* event) {
  return enqueue({queue, wait_count, waits, event, blocking != CL_FALSE},
                 moved(timeline::CommandKind::read, bytes), [&](cl_event* e) {
                   return target().clEnqueueReadBuffer(queue, buffer, CL_FALSE, offset, bytes, host,
                                                       wait_count, waits, e);
                 });
}

cl_int CL_API_CALL write_buffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
                                std::size_t offset, std::size_t bytes, const void* host,
                                cl_uint wait_count, const cl_event* waits, cl_event* event) {
  const MemoryUse uses[] = {{buffer, false, true}};
  return enqueue({queue, wait_count, waits, event, blocking != CL_FALSE, uses},
                 moved(timeline::CommandKind::write, bytes), [&](cl_event* e) {
                   return target().clEnqueueWriteBuffer(queue, buffer, CL_FALSE, offset, bytes,
                                                        host, wait_count, waits, e);
                 });
}

cl_int CL_API_CALL read_rect(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
                             const std::size_t* buffer_origin, const std::size_t* host_origin,
                             const std::size_t* region, std::size_t buffer_row,
                             std::size_t buffer_slice, std::size_t host_row, std::size_t host_slice,
                             void* host, cl_uint wait_count, const cl_event* waits,
                             cl_event* event) {
  return enqueue({queue, wait_count, waits, event, blocking != CL_FALSE},
                 moved(timeline::CommandKind::read, volume(region)), [&](cl_event* e) {
                   return target().clEnqueueReadBufferRect(
                       queue, buffer, CL_FALSE, buffer_origin, host_origin, region, buffer_row,
                       buffer_slice, host_row, host_slice, host, wait_count, waits, e);
                 });
}

cl_int CL_API_CALL write_rect(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
                              const std::size_t* buffer_origin, const std::size_t* host_origin,
                              const std::size_t* region, std::size_t buffer_row,
                              std::size_t buffer_slice, std::size_t host_row,
                              std::size_t host_slice, const void* host, cl_uint wait_count,
                              const cl_event* waits, cl_event* event) {
  const MemoryUse uses[] = {{buffer, false, true}};
  return enqueue({queue, wait_count, waits, event, blocking != CL_FALSE, uses},
                 moved(timeline::CommandKind::write, volume(region)), [&](cl_event* e) {
                   return target().clEnqueueWriteBufferRect(
                       queue, buffer, CL_FALSE, buffer_origin, host_origin, region, buffer_row,
                       buffer_slice, host_row, host_slice, host, wait_count, waits, e);
                 });
}

}  // namespace

void add_transfer_calls(cl_icd_dispatch& table) {
  table.clEnqueueReadBuffer = read_buffer;
  table.clEnqueueWriteBuffer = write_buffer;
  table.clEnqueueReadBufferRect = read_rect;
  table.clEnqueueWriteBufferRect = write_rect;
}

}  // namespace partita::layer
