#include "devices/layer/whole_device.h"

namespace partita::layer {

WholeDeviceQueue::WholeDeviceQueue(cl_command_queue like, cl_int& error) {
  cl_context context = nullptr;
  error = target().clGetCommandQueueInfo(like, CL_QUEUE_CONTEXT, sizeof context, &context, nullptr);
  if (error == CL_SUCCESS) {
    queue_ = target().clCreateCommandQueue(context, state().real_device, 0, &error);
  }
}

WholeDeviceQueue::~WholeDeviceQueue() {
  if (queue_) target().clReleaseCommandQueue(queue_);
}

void set_command_type(const cl_event* event, cl_command_type type) {
  if (!event) return;
  const Lock lock(state().mutex);
  const auto it = state().events.find(*event);
  if (it != state().events.end()) it->second.type = type;
}

std::vector<cl_event> with_marker(const Enqueue& e, cl_event before) {
  std::vector<cl_event> waits(e.waits, e.waits + e.wait_count);
  waits.push_back(before);
  return waits;
}

}  // namespace partita::layer
