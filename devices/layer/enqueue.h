// One way for every command: to the driver, then onto the predicted clock.
#ifndef PARTITA_DEVICES_LAYER_ENQUEUE_H
#define PARTITA_DEVICES_LAYER_ENQUEUE_H

#include <memory>

#include "devices/layer/call.h"
#include "devices/layer/residence.h"

namespace partita::layer {

/// The arguments that all enqueue calls share.
struct Enqueue {
  cl_command_queue queue = nullptr;
  cl_uint wait_count = 0;
  const cl_event* waits = nullptr;
  cl_event* event = nullptr;  ///< where the program wants one
  bool blocking = false;
  std::span<const MemoryUse> uses = {};  ///< what may have to be moved from another device first
};

std::shared_ptr<Queue> find_queue(cl_command_queue handle);

/// CL_INVALID_EVENT_WAIT_LIST for a list that PoCL would follow into nothing.
cl_int check_wait_list(const Enqueue& e);

/// Whether the driver must make an event for this command.
bool needs_event(const Enqueue& e);

/// Counts the command towards the device's faults; a stall goes onto the timeline at once.
cl_int before_command(const Queue& queue);

/// The driver took the command: places it, gives its event to the program or to the record, and
/// waits if it is blocking.
cl_int after_command(const Queue& queue, const Enqueue& e, timeline::Command command,
                     cl_event event);

/// `call(cl_event*)` is the driver's enqueue, never blocking: blocking calls enqueue, place, and
/// then wait, so that a command is on the clock before anybody can see its end.
template <typename Call>
cl_int enqueue_on(const Queue& queue, const Enqueue& e, const timeline::Command& command,
                  Call&& call) {
  if (const cl_int error = check_wait_list(e); error != CL_SUCCESS) return error;
  if (const cl_int error = before_command(queue); error != CL_SUCCESS) return error;
  cl_event event = nullptr;
  const cl_int error = call(needs_event(e) ? &event : nullptr);
  return error == CL_SUCCESS ? after_command(queue, e, command, event) : error;
}

/// The same from the queue's handle.
template <typename Call>
cl_int enqueue(const Enqueue& e, const timeline::Command& command, Call&& call) {
  return guarded([&]() -> cl_int {
    const auto queue = find_queue(e.queue);
    return queue ? enqueue_on(*queue, e, command, call) : CL_INVALID_COMMAND_QUEUE;
  });
}

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_ENQUEUE_H
