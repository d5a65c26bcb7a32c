// Copies and fills inside a device's memory, and migration over its link.
#include "devices/layer/calls.h"
#include "devices/layer/commands.h"
#include "devices/layer/handles.h"
#include "devices/layer/memory.h"

namespace partita::layer {
namespace {

using timeline::CommandKind;

cl_int CL_API_CALL copy_buffer(cl_command_queue queue, cl_mem from, cl_mem to,
                               std::size_t from_offset, std::size_t to_offset, std::size_t bytes,
                               cl_uint wait_count, const cl_event* waits, cl_event* event) {
  const MemoryUse uses[] = {{from, true, false}, {to, false, true}};
  return enqueue({queue, wait_count, waits, event, false, uses},
                 inside(queue, CommandKind::copy, bytes), [&](cl_event* e) {
                   return target().clEnqueueCopyBuffer(queue, from, to, from_offset, to_offset,
                                                       bytes, wait_count, waits, e);
                 });
}

cl_int CL_API_CALL copy_rect(cl_command_queue queue, cl_mem from, cl_mem to,
                             const std::size_t* from_origin, const std::size_t* to_origin,
                             const std::size_t* region, std::size_t from_row,
                             std::size_t from_slice, std::size_t to_row, std::size_t to_slice,
                             cl_uint wait_count, const cl_event* waits, cl_event* event) {
  const MemoryUse uses[] = {{from, true, false}, {to, false, true}};
  return enqueue({queue, wait_count, waits, event, false, uses},
                 inside(queue, CommandKind::copy, volume(region)), [&](cl_event* e) {
                   return target().clEnqueueCopyBufferRect(queue, from, to, from_origin, to_origin,
                                                           region, from_row, from_slice, to_row,
                                                           to_slice, wait_count, waits, e);
                 });
}

cl_int CL_API_CALL fill_buffer(cl_command_queue queue, cl_mem buffer, const void* pattern,
                               std::size_t pattern_bytes, std::size_t offset, std::size_t bytes,
                               cl_uint wait_count, const cl_event* waits, cl_event* event) {
  const MemoryUse uses[] = {{buffer, false, true}};
  return enqueue({queue, wait_count, waits, event, false, uses},
                 inside(queue, CommandKind::fill, bytes), [&](cl_event* e) {
                   return target().clEnqueueFillBuffer(queue, buffer, pattern, pattern_bytes,
                                                       offset, bytes, wait_count, waits, e);
                 });
}

/// To the host, to the device, or, where the contents do not matter, nowhere.
timeline::Command migration(cl_uint count, const cl_mem* mems, cl_mem_migration_flags flags) {
  std::uint64_t bytes = 0;
  for (cl_uint i = 0; mems && i < count; ++i) {
    const auto memory = find_memory(mems[i]);
    bytes += memory ? memory->bytes : 0;
  }
  if (flags & CL_MIGRATE_MEM_OBJECT_CONTENT_UNDEFINED) bytes = 0;
  return moved(flags & CL_MIGRATE_MEM_OBJECT_HOST ? CommandKind::read : CommandKind::write, bytes);
}

cl_int CL_API_CALL migrate(cl_command_queue queue, cl_uint count, const cl_mem* mems,
                           cl_mem_migration_flags flags, cl_uint wait_count, const cl_event* waits,
                           cl_event* event) {
  if (mems && !valid_handles(count, mems)) return CL_INVALID_MEM_OBJECT;
  std::vector<MemoryUse> uses;
  const bool to_device = (flags & CL_MIGRATE_MEM_OBJECT_HOST) == 0;
  for (cl_uint i = 0; mems && i < count; ++i) uses.push_back({mems[i], false, to_device});
  return enqueue({queue, wait_count, waits, event, false, uses}, migration(count, mems, flags),
                 [&](cl_event* e) {
                   return target().clEnqueueMigrateMemObjects(queue, count, mems, flags, wait_count,
                                                              waits, e);
                 });
}

}  // namespace

void add_copy_calls(cl_icd_dispatch& table) {
  table.clEnqueueCopyBuffer = copy_buffer;
  table.clEnqueueCopyBufferRect = copy_rect;
  table.clEnqueueFillBuffer = fill_buffer;
  table.clEnqueueMigrateMemObjects = migrate;
}

}  // namespace partita::layer
