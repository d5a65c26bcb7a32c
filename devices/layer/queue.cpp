// Command queues. While recording, the driver's queues measure even where the program did not ask
// for it; the program's queries show what it asked for.
#include <algorithm>

#include "devices/layer/answer.h"
#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/enqueue.h"
#include "devices/layer/record.h"

namespace partita::layer {
namespace {

/// CL_SUCCESS if the device has the properties.
cl_int check_properties(const Device& device, cl_command_queue_properties properties) {
  constexpr cl_command_queue_properties kKnown = CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE |
                                                 CL_QUEUE_PROFILING_ENABLE | CL_QUEUE_ON_DEVICE |
                                                 CL_QUEUE_ON_DEVICE_DEFAULT;
  if (properties & ~kKnown) return CL_INVALID_VALUE;
  if (properties & (CL_QUEUE_ON_DEVICE | CL_QUEUE_ON_DEVICE_DEFAULT)) {
    return CL_INVALID_QUEUE_PROPERTIES;
  }
  const bool out_of_order = (properties & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE) != 0;
  return out_of_order && !device.cl.out_of_order_queues ? CL_INVALID_QUEUE_PROPERTIES : CL_SUCCESS;
}

std::shared_ptr<Context> check_device(cl_context context_handle, const Device* device,
                                      cl_int& error) {
  const Lock lock(state().mutex);
  auto context = state().contexts.find(context_handle);
  if (!context) {
    error = CL_INVALID_CONTEXT;
  } else if (!device || std::find(context->devices.begin(), context->devices.end(), device) ==
                            context->devices.end()) {
    error = CL_INVALID_DEVICE;
  } else if (device->fault.lost()) {
    error = CL_OUT_OF_RESOURCES;
  }
  return context;
}

cl_command_queue_properties driver_properties(cl_command_queue_properties properties) {
  return properties | (state().recording ? CL_QUEUE_PROFILING_ENABLE : 0);
}

void add_queue(cl_command_queue handle, std::shared_ptr<Context> context, Device& device,
               cl_command_queue_properties properties, std::vector<cl_queue_properties> list) {
  auto queue = std::make_shared<Queue>();
  queue->context = std::move(context);
  queue->device = &device;
  queue->properties = properties;
  queue->list = std::move(list);
  const Lock lock(state().mutex);
  queue->id = state().timeline->add_queue(
      device.index, (properties & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE) != 0);
  state().queues.add(handle, std::move(queue));
}

cl_command_queue CL_API_CALL create_queue(cl_context context_handle, cl_device_id device_handle,
                                          cl_command_queue_properties properties,
                                          cl_int* errcode_ret) {
  return guarded_object<cl_command_queue>(errcode_ret, [&](cl_int& error) -> cl_command_queue {
    Device* device = find_device(device_handle);
    auto context = check_device(context_handle, device, error);
    if (error == CL_SUCCESS) error = check_properties(*device, properties);
    if (error != CL_SUCCESS) return nullptr;
    const cl_command_queue queue = target().clCreateCommandQueue(
        context_handle, device_handle, driver_properties(properties), &error);
    if (queue) add_queue(queue, std::move(context), *device, properties, {});
    return queue;
  });
}

cl_command_queue CL_API_CALL create_queue_with_properties(cl_context context_handle,
                                                          cl_device_id device_handle,
                                                          const cl_queue_properties* list,
                                                          cl_int* errcode_ret) {
  return guarded_object<cl_command_queue>(errcode_ret, [&](cl_int& error) -> cl_command_queue {
    Device* device = find_device(device_handle);
    auto context = check_device(context_handle, device, error);
    if (error != CL_SUCCESS) return nullptr;
    cl_command_queue_properties properties = 0;
    std::vector<cl_queue_properties> given, driver;
    for (const cl_queue_properties* p = list; p && *p; p += 2) {
      given.insert(given.end(), {p[0], p[1]});
      if (p[0] == CL_QUEUE_PROPERTIES) {
        properties = p[1];
      } else {
        driver.insert(driver.end(), {p[0], p[1]});
      }
    }
    if (list) given.push_back(0);
    error = check_properties(*device, properties);
    if (error != CL_SUCCESS) return nullptr;
    driver.insert(driver.end(), {CL_QUEUE_PROPERTIES, driver_properties(properties), 0});
    const cl_command_queue queue = target().clCreateCommandQueueWithProperties(
        context_handle, device_handle, driver.data(), &error);
    if (queue) add_queue(queue, std::move(context), *device, properties, std::move(given));
    return queue;
  });
}

cl_int CL_API_CALL get_queue_info(cl_command_queue handle, cl_command_queue_info name,
                                  std::size_t size, void* value, std::size_t* size_ret) {
  return guarded([&]() -> cl_int {
    std::shared_ptr<Queue> queue;
    {
      const Lock lock(state().mutex);
      queue = state().queues.find(handle);
    }
    const Answer answer(size, value, size_ret);
    if (!queue) return target().clGetCommandQueueInfo(handle, name, size, value, size_ret);
    switch (name) {
      case CL_QUEUE_PROPERTIES:
        return answer.put(queue->properties);
      case CL_QUEUE_PROPERTIES_ARRAY:
        return answer.put_list(queue->list);
      case CL_QUEUE_DEVICE:
        return answer.put(queue->device->handle);
      case CL_QUEUE_SIZE:  // device queues have one; there are none
        return CL_INVALID_COMMAND_QUEUE;
      case CL_QUEUE_DEVICE_DEFAULT:
        return answer.put<cl_command_queue>(nullptr);
      default:
        return target().clGetCommandQueueInfo(handle, name, size, value, size_ret);
    }
  });
}

/// A call of OpenCL 1.0, which no later device has to offer. PoCL has no function for it.
cl_int CL_API_CALL set_queue_property(cl_command_queue handle,
                                      cl_command_queue_properties properties, cl_bool,
                                      cl_command_queue_properties*) {
  return guarded([&]() -> cl_int {
    const auto queue = find_queue(handle);
    if (!queue) return CL_INVALID_COMMAND_QUEUE;
    const cl_int error = check_properties(*queue->device, properties);
    return error == CL_SUCCESS ? CL_INVALID_OPERATION : error;
  });
}

/// There are no device queues.
cl_int CL_API_CALL set_default_device_queue(cl_context context_handle, cl_device_id device_handle,
                                            cl_command_queue) {
  return guarded([&]() -> cl_int {
    cl_int error = CL_SUCCESS;
    check_device(context_handle, find_device(device_handle), error);
    return error == CL_SUCCESS ? CL_INVALID_OPERATION : error;
  });
}

cl_int CL_API_CALL retain_queue(cl_command_queue handle) {
  return guarded([&]() -> cl_int {
    const cl_int error = target().clRetainCommandQueue(handle);
    if (error == CL_SUCCESS) {
      const Lock lock(state().mutex);
      state().queues.retain(handle);
    }
    return error;
  });
}

cl_int CL_API_CALL release_queue(cl_command_queue handle) {
  return guarded([&]() -> cl_int {
    {
      const Lock lock(state().mutex);
      const auto last = state().queues.release(handle);
      if (last) state().timeline->remove_queue(last->id);
    }
    return target().clReleaseCommandQueue(handle);
  });
}

}  // namespace

void add_queue_calls(cl_icd_dispatch& table) {
  table.clCreateCommandQueue = create_queue;
  table.clCreateCommandQueueWithProperties = create_queue_with_properties;
  table.clGetCommandQueueInfo = get_queue_info;
  table.clSetCommandQueueProperty = set_queue_property;
  table.clSetDefaultDeviceCommandQueue = set_default_device_queue;
  table.clRetainCommandQueue = retain_queue;
  table.clReleaseCommandQueue = release_queue;
}

}  // namespace partita::layer
