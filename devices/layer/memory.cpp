// Buffers: limits of size and alignment, and the devices' memory.
#include "devices/layer/memory.h"

#include <algorithm>

#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/program.h"

namespace partita::layer {

std::shared_ptr<Memory> reserve(std::shared_ptr<Context> context, std::uint64_t bytes,
                                cl_int& error) {
  auto memory = std::make_shared<Memory>();
  memory->bytes = bytes;
  for (Device* device : context->devices) {
    error = device->fault.next_allocation();
    if (error != CL_SUCCESS) return nullptr;
    memory->charged.push_back(device);
    if ((device->allocated += bytes) > device->cl.global_mem_size) {
      error = CL_MEM_OBJECT_ALLOCATION_FAILURE;
      return nullptr;
    }
  }
  memory->context = std::move(context);
  return memory;
}

std::shared_ptr<Memory> find_memory(cl_mem handle) {
  const Lock lock(state().mutex);
  return state().memories.find(handle);
}

void register_memory(cl_mem handle, std::shared_ptr<Memory> memory) {
  const Lock lock(state().mutex);
  state().memories.add(handle, std::move(memory));
}

void charge_initial_copy(const Context& context, std::uint64_t bytes) {
  if (context.devices.size() != 1) return;
  State& s = state();
  const Lock lock(s.mutex);
  const timeline::ThreadId thread = current_thread();
  const timeline::QueueId queue = s.timeline->add_queue(context.devices[0]->index, false);
  timeline::Command command;
  command.queue = queue;
  command.kind = timeline::CommandKind::write;
  command.name = s.timeline->intern("create buffer");
  command.bytes = bytes;
  const timeline::NodeId node = s.timeline->enqueue(thread, command);
  s.timeline->wait(thread, {&node, 1});
  s.timeline->release(node);
  s.timeline->remove_queue(queue);
}

namespace {

/// A buffer must be possible on at least one of the devices.
bool too_large(const Context& context, std::uint64_t bytes) {
  return std::all_of(context.devices.begin(), context.devices.end(),
                     [&](const Device* d) { return bytes > d->cl.max_mem_alloc_size; });
}

template <typename Create>
cl_mem create(cl_context handle, cl_mem_flags flags, std::size_t bytes, cl_int& error,
              Create&& driver_create) {
  auto context = known_context(handle);
  if (!context) return driver_create(error);
  if (too_large(*context, bytes)) {
    error = CL_INVALID_BUFFER_SIZE;
    return nullptr;
  }
  auto memory = reserve(std::move(context), bytes, error);
  if (!memory) return nullptr;
  const cl_mem buffer = driver_create(error);
  if (!buffer) return nullptr;
  if (flags & CL_MEM_COPY_HOST_PTR) charge_initial_copy(*memory->context, bytes);
  register_memory(buffer, std::move(memory));
  return buffer;
}

cl_mem CL_API_CALL create_buffer(cl_context context, cl_mem_flags flags, std::size_t bytes,
                                 void* host, cl_int* errcode_ret) {
  return guarded_object<cl_mem>(errcode_ret, [&](cl_int& error) {
    return create(context, flags, bytes, error, [&](cl_int& e) {
      return target().clCreateBuffer(context, flags, bytes, host, &e);
    });
  });
}

cl_mem CL_API_CALL create_buffer_with_properties(cl_context context,
                                                 const cl_mem_properties* properties,
                                                 cl_mem_flags flags, std::size_t bytes, void* host,
                                                 cl_int* errcode_ret) {
  return guarded_object<cl_mem>(errcode_ret, [&](cl_int& error) {
    return create(context, flags, bytes, error, [&](cl_int& e) {
      return target().clCreateBufferWithProperties(context, properties, flags, bytes, host, &e);
    });
  });
}

bool aligned_somewhere(const Context& context, std::uint64_t origin) {
  return std::any_of(context.devices.begin(), context.devices.end(), [&](const Device* d) {
    const std::uint64_t bytes = std::max<std::uint64_t>(1, d->cl.mem_base_addr_align_bits / 8);
    return origin % bytes == 0;
  });
}

cl_mem CL_API_CALL create_sub_buffer(cl_mem parent_handle, cl_mem_flags flags,
                                     cl_buffer_create_type type, const void* info,
                                     cl_int* errcode_ret) {
  return guarded_object<cl_mem>(errcode_ret, [&](cl_int& error) -> cl_mem {
    const cl_mem buffer = target().clCreateSubBuffer(parent_handle, flags, type, info, &error);
    auto parent = find_memory(parent_handle);
    if (!buffer || !parent) return buffer;
    const auto* region = static_cast<const cl_buffer_region*>(info);
    if (!aligned_somewhere(*parent->context, region->origin)) {
      target().clReleaseMemObject(buffer);
      error = CL_MISALIGNED_SUB_BUFFER_OFFSET;
      return nullptr;
    }
    auto memory = std::make_shared<Memory>();
    memory->context = parent->context;
    memory->bytes = region->size;
    memory->parent = std::move(parent);
    register_memory(buffer, std::move(memory));
    return buffer;
  });
}

cl_int CL_API_CALL retain_memory(cl_mem handle) {
  return guarded([&]() -> cl_int {
    const cl_int error = target().clRetainMemObject(handle);
    if (error == CL_SUCCESS) {
      const Lock lock(state().mutex);
      state().memories.retain(handle);
    }
    return error;
  });
}

cl_int CL_API_CALL release_memory(cl_mem handle) {
  return guarded([&]() -> cl_int {
    {
      const Lock lock(state().mutex);
      state().memories.release(handle);
    }
    return target().clReleaseMemObject(handle);
  });
}

}  // namespace

void add_memory_calls(cl_icd_dispatch& table) {
  table.clCreateBuffer = create_buffer;
  table.clCreateBufferWithProperties = create_buffer_with_properties;
  table.clCreateSubBuffer = create_sub_buffer;
  table.clRetainMemObject = retain_memory;
  table.clReleaseMemObject = release_memory;
}

}  // namespace partita::layer
