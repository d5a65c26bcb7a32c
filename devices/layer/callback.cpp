// clSetEventCallback: a callback runs on a thread of the driver's, at its event's predicted time.
#include <memory>

#include "devices/layer/call.h"
#include "devices/layer/calls.h"

namespace partita::layer {
namespace {

using Function = void(CL_CALLBACK*)(cl_event, cl_int, void*);

struct Callback {
  Function function = nullptr;
  void* user_data = nullptr;
  timeline::NodeId node = timeline::kNone;  ///< holds a reference
  timeline::CallbackAt at = timeline::CallbackAt::end;
};

timeline::CallbackAt time_of(cl_int type) {
  switch (type) {
    case CL_SUBMITTED:
      return timeline::CallbackAt::submit;
    case CL_RUNNING:
      return timeline::CallbackAt::start;
    default:
      return timeline::CallbackAt::end;
  }
}

/// Runs the program's function with the event's clock; with the thread's own if the command has
/// no time yet.
void run(const Callback& callback, cl_event event, cl_int status) {
  State& s = state();
  timeline::ThreadId thread = timeline::kNone;
  {
    const Lock lock(s.mutex);
    if (s.timeline->resolved(callback.node)) {
      thread = s.timeline->begin_callback(callback.node, callback.at);
    }
  }
  if (thread == timeline::kNone) {
    callback.function(event, status, callback.user_data);
    return;
  }
  {
    const ActAs act(thread);
    callback.function(event, status, callback.user_data);
  }
  const Lock lock(s.mutex);
  s.timeline->end_callback(thread);
}

void CL_CALLBACK trampoline(cl_event event, cl_int status, void* data) {
  const std::unique_ptr<Callback> callback(static_cast<Callback*>(data));
  guarded([&]() -> cl_int {
    run(*callback, event, status);
    const Lock lock(state().mutex);
    state().timeline->release(callback->node);
    return CL_SUCCESS;
  });
}

cl_int CL_API_CALL set_event_callback(cl_event handle, cl_int type, Function function,
                                      void* user_data) {
  return guarded([&]() -> cl_int {
    auto callback = std::make_unique<Callback>();
    {
      const Lock lock(state().mutex);
      const auto it = state().events.find(handle);
      if (it != state().events.end() && function) {
        callback->node = it->second.node;
        state().timeline->retain(callback->node);
      }
    }
    if (callback->node == timeline::kNone) {
      return target().clSetEventCallback(handle, type, function, user_data);
    }
    callback->function = function;
    callback->user_data = user_data;
    callback->at = time_of(type);
    const timeline::NodeId node = callback->node;
    Callback* const data = callback.release();  // the trampoline's from here on
    const cl_int error = target().clSetEventCallback(handle, type, trampoline, data);
    if (error != CL_SUCCESS) {
      delete data;
      const Lock lock(state().mutex);
      state().timeline->release(node);
    }
    return error;
  });
}

}  // namespace

void add_callback_calls(cl_icd_dispatch& table) {
  table.clSetEventCallback = set_event_callback;
}

}  // namespace partita::layer
