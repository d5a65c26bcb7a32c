// cl_partita_predicted_time: the functions of devices/work.h. And clGetExtensionFunctionAddress,
// which finds them; the driver's own extensions are hidden with its platform.
#include <cstring>

#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/declared_work.h"
#include "devices/layer/record.h"

namespace partita::layer {
namespace {

struct Declared {
  cl_command_queue queue = nullptr;
  Work work;
};
thread_local std::vector<Declared> declared;

bool valid(const Work* work) {
  return work && work->struct_size == sizeof(Work);
}

cl_int CL_API_CALL set_work(cl_command_queue queue, const Work* work) {
  return guarded([&]() -> cl_int {
    if (!queue) return CL_INVALID_COMMAND_QUEUE;
    if (!valid(work)) return CL_INVALID_VALUE;
    for (Declared& d : declared) {
      if (d.queue == queue) {
        d.work = *work;
        return CL_SUCCESS;
      }
    }
    declared.push_back({queue, *work});
    return CL_SUCCESS;
  });
}

cl_int CL_API_CALL bind_thread(const char* name, cl_uint rank, cl_device_id near_handle) {
  return guarded([&]() -> cl_int {
    if (!name) return CL_INVALID_VALUE;
    if (!open_machine()) return CL_INVALID_PLATFORM;
    const Device* near_device = find_device(near_handle);
    if (near_handle && !near_device) return CL_INVALID_DEVICE;
    const Lock lock(state().mutex);
    state().timeline->bind_thread(current_thread(), name, rank,
                                  near_device ? near_device->index : timeline::kNone);
    set_current_node(near_device ? near_device->machine.node : state().machine.main_node);
    return CL_SUCCESS;
  });
}

/// What the following functions share: a machine, the lock and the thread.
template <typename Body>
cl_int on_thread(bool valid_arguments, Body&& body) {
  return guarded([&]() -> cl_int {
    if (!valid_arguments) return CL_INVALID_VALUE;
    if (!open_machine()) return CL_INVALID_PLATFORM;
    const Lock lock(state().mutex);
    body(*state().timeline, current_thread());
    return CL_SUCCESS;
  });
}

cl_int CL_API_CALL set_label(const char* task, cl_long frame) {
  return on_thread(true, [&](timeline::Timeline& t, timeline::ThreadId thread) {
    t.set_label(thread, t.intern(task ? task : ""), frame);
  });
}

cl_int CL_API_CALL host_step(const char* name, const Work* work) {
  return on_thread(name && valid(work), [&](timeline::Timeline& t, timeline::ThreadId thread) {
    const model::Cost cost = state().hosts[current_node()].host_step(*work);
    t.release(t.host_step(thread, t.intern(name), timeline::demand_of(cost), work));
  });
}

cl_int CL_API_CALL sensor_input(const char* name, cl_ulong bytes) {
  return on_thread(name, [&](timeline::Timeline& t, timeline::ThreadId thread) {
    t.release(t.sensor_input(thread, t.intern(name), bytes));
  });
}

cl_int CL_API_CALL wait_until(cl_ulong ns) {
  return on_thread(
      true, [&](timeline::Timeline& t, timeline::ThreadId thread) { t.wait_until(thread, ns); });
}

cl_int CL_API_CALL host_clock(cl_ulong* ns) {
  return on_thread(
      ns, [&](timeline::Timeline& t, timeline::ThreadId thread) { *ns = t.clock(thread); });
}

cl_int CL_API_CALL export_record_call(const char* path) {
  return guarded([&]() -> cl_int { return path ? export_record(path) : CL_INVALID_VALUE; });
}

void* find_function(const char* name) {
  struct Entry {
    const char* name;
    void* function;
  };
  static const Entry kFunctions[] = {
      {kBindThread, reinterpret_cast<void*>(bind_thread)},
      {kSetLabel, reinterpret_cast<void*>(set_label)},
      {kSetWork, reinterpret_cast<void*>(set_work)},
      {kHostStep, reinterpret_cast<void*>(host_step)},
      {kSensorInput, reinterpret_cast<void*>(sensor_input)},
      {kWaitUntil, reinterpret_cast<void*>(wait_until)},
      {kHostClock, reinterpret_cast<void*>(host_clock)},
      {kExportRecord, reinterpret_cast<void*>(export_record_call)},
  };
  for (const Entry& entry : kFunctions) {
    if (name && std::strcmp(name, entry.name) == 0) return entry.function;
  }
  return nullptr;
}

void* CL_API_CALL function_for_platform(cl_platform_id platform, const char* name) {
  try {
    return find_platform(platform) ? find_function(name) : nullptr;
  } catch (const std::exception& error) {
    report(error);
    return nullptr;
  }
}

void* CL_API_CALL function_address(const char* name) {
  return find_function(name);
}

}  // namespace

bool take_declared_work(cl_command_queue queue, Work& work) {
  for (std::size_t i = 0; i < declared.size(); ++i) {
    if (declared[i].queue != queue) continue;
    work = declared[i].work;
    declared[i] = declared.back();
    declared.pop_back();
    return true;
  }
  return false;
}

void add_extension_calls(cl_icd_dispatch& table) {
  table.clGetExtensionFunctionAddressForPlatform = function_for_platform;
  table.clGetExtensionFunctionAddress = function_address;
}

}  // namespace partita::layer
