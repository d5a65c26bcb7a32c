// Contexts. The driver sees its own platform and the sub-devices; the program sees what it gave.
#include <algorithm>
#include <cstring>

#include "devices/layer/answer.h"
#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/select.h"

namespace partita::layer {
namespace {

using Notify = void(CL_CALLBACK*)(const char*, const void*, std::size_t, void*);

struct ParsedProperties {
  std::vector<cl_context_properties> given;   ///< with the final 0; empty if there were none
  std::vector<cl_context_properties> driver;  ///< the platform replaced by the driver's own
  Platform* platform = nullptr;
};

cl_int parse_properties(const cl_context_properties* properties, ParsedProperties& parsed) {
  for (const cl_context_properties* p = properties; p && *p; p += 2) {
    for (std::size_t i = 0; i < parsed.given.size(); i += 2) {
      if (parsed.given[i] == p[0]) return CL_INVALID_PROPERTY;
    }
    cl_context_properties value = p[1];
    if (p[0] == CL_CONTEXT_PLATFORM) {
      parsed.platform = find_platform(reinterpret_cast<cl_platform_id>(value));
      if (!parsed.platform) return CL_INVALID_PLATFORM;
      value = reinterpret_cast<cl_context_properties>(state().real_platform);
    }
    parsed.given.insert(parsed.given.end(), {p[0], p[1]});
    parsed.driver.insert(parsed.driver.end(), {p[0], value});
  }
  if (properties) parsed.given.push_back(0);
  if (!parsed.platform) {
    parsed.driver.insert(
        parsed.driver.end(),
        {CL_CONTEXT_PLATFORM, reinterpret_cast<cl_context_properties>(state().real_platform)});
  }
  parsed.driver.push_back(0);
  return CL_SUCCESS;
}

cl_context make_context(const ParsedProperties& parsed, std::vector<Device*> devices, Notify notify,
                        void* user_data, cl_int& error) {
  std::vector<cl_device_id> handles;
  for (const Device* d : devices) {
    if (d->fault.lost()) error = CL_DEVICE_NOT_AVAILABLE;
    handles.push_back(d->handle);
  }
  if (error != CL_SUCCESS) return nullptr;
  const cl_context context =
      target().clCreateContext(parsed.driver.data(), static_cast<cl_uint>(handles.size()),
                               handles.data(), notify, user_data, &error);
  if (!context) return nullptr;
  auto entry = std::make_shared<Context>();
  entry->devices = std::move(devices);
  entry->properties = parsed.given;
  entry->notify = notify;
  entry->user_data = user_data;
  const Lock lock(state().mutex);
  state().contexts.add(context, std::move(entry));
  return context;
}

cl_context CL_API_CALL create_context(const cl_context_properties* properties, cl_uint count,
                                      const cl_device_id* handles, Notify notify, void* user_data,
                                      cl_int* errcode_ret) {
  return guarded_object<cl_context>(errcode_ret, [&](cl_int& error) -> cl_context {
    ParsedProperties parsed;
    if (!open_machine()) {
      error = CL_INVALID_PLATFORM;
    } else if (!handles || count == 0 || (!notify && user_data)) {
      error = CL_INVALID_VALUE;
    } else {
      error = parse_properties(properties, parsed);
    }
    std::vector<Device*> devices;
    for (cl_uint i = 0; error == CL_SUCCESS && i < count; ++i) {
      Device* device = find_device(handles[i]);
      const Platform* platform = parsed.platform   ? parsed.platform
                                 : devices.empty() ? (device ? device->platform : nullptr)
                                                   : devices[0]->platform;
      if (!device || device->platform != platform) {
        error = CL_INVALID_DEVICE;
      } else if (std::find(devices.begin(), devices.end(), device) == devices.end()) {
        devices.push_back(device);
      }
    }
    if (error != CL_SUCCESS) return nullptr;
    return make_context(parsed, std::move(devices), notify, user_data, error);
  });
}

cl_context CL_API_CALL create_context_from_type(const cl_context_properties* properties,
                                                cl_device_type type, Notify notify, void* user_data,
                                                cl_int* errcode_ret) {
  return guarded_object<cl_context>(errcode_ret, [&](cl_int& error) -> cl_context {
    ParsedProperties parsed;
    if (!open_machine()) {
      error = CL_INVALID_PLATFORM;
    } else if (!notify && user_data) {
      error = CL_INVALID_VALUE;
    } else if (!valid_device_type(type)) {
      error = CL_INVALID_DEVICE_TYPE;
    } else {
      error = parse_properties(properties, parsed);
    }
    if (error != CL_SUCCESS) return nullptr;
    const Platform& platform = parsed.platform ? *parsed.platform : *state().platforms[0];
    std::vector<Device*> devices = select_devices(platform, type);
    if (devices.empty()) {
      error = CL_DEVICE_NOT_FOUND;
      return nullptr;
    }
    return make_context(parsed, std::move(devices), notify, user_data, error);
  });
}

std::shared_ptr<Context> find_context(cl_context handle) {
  const Lock lock(state().mutex);
  return state().contexts.find(handle);
}

cl_int CL_API_CALL get_context_info(cl_context handle, cl_context_info name, std::size_t size,
                                    void* value, std::size_t* size_ret) {
  return guarded([&]() -> cl_int {
    const auto context = find_context(handle);
    if (!context) return target().clGetContextInfo(handle, name, size, value, size_ret);
    const Answer answer(size, value, size_ret);
    std::vector<cl_device_id> devices;
    for (const Device* d : context->devices) devices.push_back(d->handle);
    switch (name) {
      case CL_CONTEXT_NUM_DEVICES:
        return answer.put(static_cast<cl_uint>(devices.size()));
      case CL_CONTEXT_DEVICES:
        return answer.put_list(devices);
      case CL_CONTEXT_PROPERTIES:
        return answer.put_list(context->properties);
      default:
        return target().clGetContextInfo(handle, name, size, value, size_ret);
    }
  });
}

cl_int CL_API_CALL retain_context(cl_context handle) {
  return guarded([&]() -> cl_int {
    const cl_int error = target().clRetainContext(handle);
    if (error == CL_SUCCESS) {
      const Lock lock(state().mutex);
      state().contexts.retain(handle);
    }
    return error;
  });
}

cl_int CL_API_CALL release_context(cl_context handle) {
  return guarded([&]() -> cl_int {
    {
      const Lock lock(state().mutex);
      state().contexts.release(handle);
    }
    return target().clReleaseContext(handle);
  });
}

}  // namespace

void add_context_calls(cl_icd_dispatch& table) {
  table.clCreateContext = create_context;
  table.clCreateContextFromType = create_context_from_type;
  table.clGetContextInfo = get_context_info;
  table.clRetainContext = retain_context;
  table.clReleaseContext = release_context;
}

}  // namespace partita::layer
