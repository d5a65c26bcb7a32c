#include "devices/layer/enqueue.h"

#include <algorithm>
#include <array>

#include "devices/layer/commands.h"
#include "devices/layer/handles.h"
#include "devices/layer/record.h"

namespace partita::layer {
namespace {

/// Nodes of a wait list; short lists, the rule, cost no allocation.
class WaitNodes {
 public:
  WaitNodes(cl_uint count, const cl_event* events) {
    if (count > few_.size()) many_.resize(count);
    timeline::NodeId* out = count > few_.size() ? many_.data() : few_.data();
    std::size_t n = 0;
    for (cl_uint i = 0; events && i < count; ++i) {
      const auto it = state().events.find(events[i]);
      if (it != state().events.end()) out[n++] = it->second.node;
    }
    nodes_ = {out, n};
  }
  std::span<const timeline::NodeId> nodes() const { return nodes_; }

 private:
  std::array<timeline::NodeId, 16> few_;
  std::vector<timeline::NodeId> many_;
  std::span<const timeline::NodeId> nodes_;
};

}  // namespace

std::shared_ptr<Queue> find_queue(cl_command_queue handle) {
  const Lock lock(state().mutex);
  return state().queues.find(handle);
}

timeline::Command inside(cl_command_queue handle, timeline::CommandKind kind, std::uint64_t bytes) {
  timeline::Command command;
  command.kind = kind;
  if (const auto queue = find_queue(handle)) {
    const model::DeviceModel& model = queue->device->model;
    command.demand = timeline::demand_of(kind == timeline::CommandKind::fill ? model.fill(bytes)
                                                                             : model.copy(bytes));
  }
  return command;
}

cl_int check_wait_list(const Enqueue& e) {
  if (e.wait_count == 0 && !e.waits) return CL_SUCCESS;
  const bool valid = e.wait_count != 0 && valid_handles(e.wait_count, e.waits);
  return valid ? CL_SUCCESS : CL_INVALID_EVENT_WAIT_LIST;
}

bool needs_event(const Enqueue& e) {
  return e.event || e.blocking || state().recording;
}

cl_int before_command(const Queue& queue) {
  std::uint64_t stall_ns = 0;
  const cl_int error = queue.device->fault.next_command(stall_ns);
  if (error == CL_SUCCESS && stall_ns) {
    State& s = state();
    const Lock lock(s.mutex);
    timeline::Command stall;
    stall.queue = queue.id;
    stall.name = s.timeline->intern("injected stall");
    stall.demand.launch_ns = stall_ns;
    s.timeline->release(s.timeline->enqueue(current_thread(), stall));
  }
  return error;
}

cl_int after_command(const Queue& queue, const Enqueue& e, timeline::Command command,
                     cl_event event) {
  State& s = state();
  const bool keep = e.blocking || s.recording;  // this call needs the node below
  timeline::NodeId node;
  timeline::ThreadId thread;
  {
    const Lock lock(s.mutex);
    const WaitNodes waits(e.wait_count, e.waits);
    thread = current_thread();
    const Moves moves(queue, thread, e.uses, waits.nodes());
    command.queue = queue.id;
    command.waits = moves.waits();
    node = s.timeline->enqueue(thread, command);
    if (e.event) s.events[event] = Event{node, 1, false, queue.profiling()};
    if (e.event && keep) s.timeline->retain(node);
    if (!e.event && !keep) s.timeline->release(node);
  }
  if (e.event) *e.event = event;
  if (!keep) return CL_SUCCESS;
  const cl_int error = e.blocking ? target().clWaitForEvents(1, &event) : CL_SUCCESS;
  if (s.recording) {
    if (e.event) target().clRetainEvent(event);
    measure(event, node);
  } else if (!e.event) {
    target().clReleaseEvent(event);
  }
  const Lock lock(s.mutex);
  if (e.blocking) s.timeline->wait(thread, {&node, 1});
  s.timeline->release(node);
  return error;
}

}  // namespace partita::layer
