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

namespace {

void CL_CALLBACK do_nothing(void*) {}

bool out_of_order(cl_command_queue handle) {
  const auto queue = find_queue(handle);
  return queue && (queue->properties & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE) != 0;
}

}  // namespace

cl_int enqueue_nothing(cl_command_queue queue, cl_uint count, const cl_event* waits,
                       cl_event* event) {
  if (!out_of_order(queue)) {
    return target().clEnqueueMarkerWithWaitList(queue, count, waits, event);
  }
  return target().clEnqueueNativeKernel(queue, do_nothing, nullptr, 0, 0, nullptr, nullptr, count,
                                        waits, event);
}

std::vector<cl_event> with_start(const Enqueue& e, cl_event start) {
  std::vector<cl_event> waits(e.waits, e.waits + e.wait_count);
  waits.push_back(start);
  return waits;
}

}  // namespace partita::layer
