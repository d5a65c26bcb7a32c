// Mapping: the bytes cross the link when a region is mapped for reading, and back when one that
// was mapped for writing is unmapped. On an SoC, where host and device share the memory, nothing
// moves; the timeline knows which is which.
#include <algorithm>

#include "devices/layer/calls.h"
#include "devices/layer/commands.h"
#include "devices/layer/memory.h"
#include "devices/layer/whole_device.h"

namespace partita::layer {
namespace {

using timeline::CommandKind;

void remember(cl_mem handle, void* pointer, cl_map_flags flags, std::uint64_t bytes) {
  const Lock lock(state().mutex);
  if (const auto memory = state().memories.find(handle)) {
    const bool writes = (flags & (CL_MAP_WRITE | CL_MAP_WRITE_INVALIDATE_REGION)) != 0;
    memory->mappings.push_back({pointer, bytes, writes});
  }
}

/// The mapping's bytes if they have to go back. A pointer can be mapped more than once.
std::uint64_t bytes_to_return(cl_mem handle, void* pointer) {
  const Lock lock(state().mutex);
  const auto memory = state().memories.find(handle);
  if (!memory) return 0;
  const auto it = std::find_if(memory->mappings.begin(), memory->mappings.end(),
                               [&](const Mapping& m) { return m.pointer == pointer; });
  return it != memory->mappings.end() && it->writes ? it->bytes : 0;
}

void forget(cl_mem handle, void* pointer) {
  const Lock lock(state().mutex);
  const auto memory = state().memories.find(handle);
  if (!memory) return;
  const auto it = std::find_if(memory->mappings.begin(), memory->mappings.end(),
                               [&](const Mapping& m) { return m.pointer == pointer; });
  if (it != memory->mappings.end()) memory->mappings.erase(it);
}

timeline::Command map_command(cl_map_flags flags, std::uint64_t bytes) {
  const bool overwrites = (flags & CL_MAP_WRITE_INVALIDATE_REGION) != 0;
  return moved(CommandKind::map, overwrites ? 0 : bytes);
}

void* CL_API_CALL map_buffer(cl_command_queue queue, cl_mem buffer, cl_bool blocking,
                             cl_map_flags flags, std::size_t offset, std::size_t bytes,
                             cl_uint wait_count, const cl_event* waits, cl_event* event,
                             cl_int* errcode_ret) {
  return guarded_object<void*>(errcode_ret, [&](cl_int& error) -> void* {
    void* pointer = nullptr;
    error = enqueue({queue, wait_count, waits, event, blocking != CL_FALSE},
                    map_command(flags, bytes), [&](cl_event* e) {
                      cl_int result = CL_SUCCESS;
                      pointer = target().clEnqueueMapBuffer(queue, buffer, CL_FALSE, flags, offset,
                                                            bytes, wait_count, waits, e, &result);
                      if (pointer) remember(buffer, pointer, flags, bytes);
                      return result;
                    });
    return error == CL_SUCCESS ? pointer : nullptr;
  });
}

void* CL_API_CALL map_image(cl_command_queue queue, cl_mem image, cl_bool blocking,
                            cl_map_flags flags, const std::size_t* origin,
                            const std::size_t* region, std::size_t* row, std::size_t* slice,
                            cl_uint wait_count, const cl_event* waits, cl_event* event,
                            cl_int* errcode_ret) {
  return guarded_object<void*>(errcode_ret, [&](cl_int& error) -> void* {
    void* pointer = nullptr;
    const std::uint64_t bytes = image_bytes(image, region);
    error = enqueue_image({queue, wait_count, waits, event, blocking != CL_FALSE},
                          CL_COMMAND_MAP_IMAGE, map_command(flags, bytes),
                          [&](cl_command_queue q, cl_uint n, const cl_event* list, cl_event* e) {
                            cl_int result = CL_SUCCESS;
                            pointer =
                                target().clEnqueueMapImage(q, image, CL_FALSE, flags, origin,
                                                           region, row, slice, n, list, e, &result);
                            if (pointer) remember(image, pointer, flags, bytes);
                            return result;
                          });
    return error == CL_SUCCESS ? pointer : nullptr;
  });
}

cl_int CL_API_CALL unmap(cl_command_queue queue, cl_mem memory, void* pointer, cl_uint wait_count,
                         const cl_event* waits, cl_event* event) {
  const std::uint64_t bytes = bytes_to_return(memory, pointer);
  const MemoryUse uses[] = {{memory, false, bytes != 0}};
  return enqueue({queue, wait_count, waits, event, false, uses}, moved(CommandKind::unmap, bytes),
                 [&](cl_event* e) {
                   const cl_int error = target().clEnqueueUnmapMemObject(queue, memory, pointer,
                                                                         wait_count, waits, e);
                   if (error == CL_SUCCESS) forget(memory, pointer);
                   return error;
                 });
}

}  // namespace

void add_map_calls(cl_icd_dispatch& table) {
  table.clEnqueueMapBuffer = map_buffer;
  table.clEnqueueMapImage = map_image;
  table.clEnqueueUnmapMemObject = unmap;
}

}  // namespace partita::layer
