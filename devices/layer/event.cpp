// Events: user events, what a program sees of them, and their predicted times.
#include "devices/layer/answer.h"
#include "devices/layer/call.h"
#include "devices/layer/calls.h"

namespace partita::layer {
namespace {

bool find_event(cl_event handle, Event& event) {
  const Lock lock(state().mutex);
  const auto it = state().events.find(handle);
  if (it == state().events.end()) return false;
  event = it->second;
  return true;
}

cl_event CL_API_CALL create_user_event(cl_context context, cl_int* errcode_ret) {
  return guarded_object<cl_event>(errcode_ret, [&](cl_int& error) -> cl_event {
    const cl_event event = target().clCreateUserEvent(context, &error);
    if (!event) return nullptr;
    const Lock lock(state().mutex);
    const timeline::NodeId node = state().timeline->create_user_event(current_thread());
    state().events[event] = Event{node, 1, true};
    return event;
  });
}

/// The timeline first: who wakes up because of the driver must find all times in place.
cl_int CL_API_CALL set_user_event_status(cl_event handle, cl_int status) {
  return guarded([&]() -> cl_int {
    if (status > CL_COMPLETE) return CL_INVALID_VALUE;
    {
      const Lock lock(state().mutex);
      const auto it = state().events.find(handle);
      if (it == state().events.end() || !it->second.user) return CL_INVALID_EVENT;
      if (it->second.status_set) return CL_INVALID_OPERATION;
      it->second.status_set = true;
      state().timeline->set_user_event(current_thread(), it->second.node, status);
    }
    return target().clSetUserEventStatus(handle, status);
  });
}

cl_int CL_API_CALL retain_event(cl_event handle) {
  return guarded([&]() -> cl_int {
    const cl_int error = target().clRetainEvent(handle);
    if (error != CL_SUCCESS) return error;
    const Lock lock(state().mutex);
    const auto it = state().events.find(handle);
    if (it != state().events.end()) ++it->second.references;
    return error;
  });
}

cl_int CL_API_CALL release_event(cl_event handle) {
  return guarded([&]() -> cl_int {
    {
      const Lock lock(state().mutex);
      const auto it = state().events.find(handle);
      if (it != state().events.end() && --it->second.references == 0) {
        const timeline::NodeId node = it->second.node;
        state().events.erase(it);
        state().timeline->release(node);
      }
    }
    return target().clReleaseEvent(handle);
  });
}

cl_int driver_status(cl_event handle) {
  cl_int status = CL_QUEUED;
  target().clGetEventInfo(handle, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status,
                          nullptr);
  return status;
}

/// Seeing that a command is complete brings the thread's clock to its end.
cl_int CL_API_CALL get_event_info(cl_event handle, cl_event_info name, std::size_t size,
                                  void* value, std::size_t* size_ret) {
  return guarded([&]() -> cl_int {
    const cl_int error = target().clGetEventInfo(handle, name, size, value, size_ret);
    Event event;
    if (error != CL_SUCCESS || !find_event(handle, event)) return error;
    if (name == CL_EVENT_REFERENCE_COUNT) {  // without the record's own references
      return Answer(size, value, size_ret).put<cl_uint>(event.references);
    }
    if (name == CL_EVENT_COMMAND_TYPE && event.type != 0) {
      return Answer(size, value, size_ret).put(event.type);
    }
    if (name == CL_EVENT_COMMAND_EXECUTION_STATUS && value &&
        *static_cast<const cl_int*>(value) <= CL_COMPLETE) {
      const Lock lock(state().mutex);
      state().timeline->observe(current_thread(), event.node);
    }
    return error;
  });
}

cl_int CL_API_CALL get_profiling_info(cl_event handle, cl_profiling_info name, std::size_t size,
                                      void* value, std::size_t* size_ret) {
  return guarded([&]() -> cl_int {
    Event event;
    if (!find_event(handle, event)) {
      return target().clGetEventProfilingInfo(handle, name, size, value, size_ret);
    }
    if (name < CL_PROFILING_COMMAND_QUEUED || name > CL_PROFILING_COMMAND_COMPLETE) {
      return CL_INVALID_VALUE;
    }
    if (event.user || !event.profiling || driver_status(handle) != CL_COMPLETE) {
      return CL_PROFILING_INFO_NOT_AVAILABLE;
    }
    timeline::Times times;
    {
      const Lock lock(state().mutex);
      if (!state().timeline->resolved(event.node)) return CL_PROFILING_INFO_NOT_AVAILABLE;
      state().timeline->observe(current_thread(), event.node);
      times = state().timeline->times(event.node);
    }
    const Answer answer(size, value, size_ret);
    switch (name) {
      case CL_PROFILING_COMMAND_QUEUED:
        return answer.put<cl_ulong>(times.queued);
      case CL_PROFILING_COMMAND_SUBMIT:
        return answer.put<cl_ulong>(times.submit);
      case CL_PROFILING_COMMAND_START:
        return answer.put<cl_ulong>(times.start);
      default:  // END, and COMPLETE: no device starts commands of its own
        return answer.put<cl_ulong>(times.end);
    }
  });
}

}  // namespace

void add_event_calls(cl_icd_dispatch& table) {
  table.clCreateUserEvent = create_user_event;
  table.clSetUserEventStatus = set_user_event_status;
  table.clRetainEvent = retain_event;
  table.clReleaseEvent = release_event;
  table.clGetEventInfo = get_event_info;
  table.clGetEventProfilingInfo = get_profiling_info;
}

}  // namespace partita::layer
