// Markers, barriers and waiting.
#include <vector>

#include "devices/layer/calls.h"
#include "devices/layer/commands.h"
#include "devices/layer/handles.h"
#include "devices/layer/record.h"

namespace partita::layer {
namespace {

using timeline::CommandKind;

cl_int CL_API_CALL marker_with_list(cl_command_queue queue, cl_uint wait_count,
                                    const cl_event* waits, cl_event* event) {
  return enqueue({queue, wait_count, waits, event, false}, waiting_only(CommandKind::marker),
                 [&](cl_event* e) {
                   return target().clEnqueueMarkerWithWaitList(queue, wait_count, waits, e);
                 });
}

cl_int CL_API_CALL barrier_with_list(cl_command_queue queue, cl_uint wait_count,
                                     const cl_event* waits, cl_event* event) {
  return enqueue({queue, wait_count, waits, event, false}, waiting_only(CommandKind::barrier),
                 [&](cl_event* e) {
                   return target().clEnqueueBarrierWithWaitList(queue, wait_count, waits, e);
                 });
}

cl_int CL_API_CALL marker(cl_command_queue queue, cl_event* event) {
  if (!event) return CL_INVALID_VALUE;
  return marker_with_list(queue, 0, nullptr, event);
}

cl_int CL_API_CALL barrier(cl_command_queue queue) {
  return barrier_with_list(queue, 0, nullptr, nullptr);
}

cl_int CL_API_CALL wait_for_events_command(cl_command_queue queue, cl_uint count,
                                           const cl_event* events) {
  if (count == 0 || !events) return CL_INVALID_VALUE;
  return barrier_with_list(queue, count, events, nullptr);
}

cl_int CL_API_CALL finish(cl_command_queue handle) {
  return guarded([&]() -> cl_int {
    const auto queue = find_queue(handle);
    const cl_int error = target().clFinish(handle);
    if (!queue || error != CL_SUCCESS) return error;
    if (state().recording) harvest();
    const Lock lock(state().mutex);
    state().timeline->finish(current_thread(), queue->id);
    return queue->device->fault.lost() ? CL_OUT_OF_RESOURCES : CL_SUCCESS;
  });
}

/// An event that ended badly has been waited for as well.
bool waited(cl_int error) {
  return error == CL_SUCCESS || error == CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST;
}

cl_int CL_API_CALL wait_for_events(cl_uint count, const cl_event* events) {
  return guarded([&]() -> cl_int {
    if (count == 0 || !events) return CL_INVALID_VALUE;
    if (!valid_handles(count, events)) return CL_INVALID_EVENT;
    const cl_int error = target().clWaitForEvents(count, events);
    if (!waited(error)) return error;
    const Lock lock(state().mutex);
    std::vector<timeline::NodeId> nodes;
    for (cl_uint i = 0; i < count; ++i) {
      const auto it = state().events.find(events[i]);
      if (it != state().events.end()) nodes.push_back(it->second.node);
    }
    state().timeline->wait(current_thread(), nodes);
    return error;
  });
}

}  // namespace

void add_sync_calls(cl_icd_dispatch& table) {
  table.clEnqueueMarkerWithWaitList = marker_with_list;
  table.clEnqueueBarrierWithWaitList = barrier_with_list;
  table.clEnqueueMarker = marker;
  table.clEnqueueBarrier = barrier;
  table.clEnqueueWaitForEvents = wait_for_events_command;
  table.clFinish = finish;
  table.clWaitForEvents = wait_for_events;
}

}  // namespace partita::layer
