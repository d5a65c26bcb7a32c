// Image commands. PoCL 3.1 aborts the process when one of them is enqueued on a sub-device's
// queue (read, write, copy, fill and map look the device up among the context's roots), so they
// run on a queue of the whole device, between two empty commands of the program's queue: the first
// ends when the command may start, the second stands for the command. None of them is a kernel: one
// worker thread executes it, beside what the sub-devices do.
#ifndef PARTITA_DEVICES_LAYER_WHOLE_DEVICE_H
#define PARTITA_DEVICES_LAYER_WHOLE_DEVICE_H

#include <vector>

#include "devices/layer/enqueue.h"

namespace partita::layer {

/// A queue on the whole device for one call; the driver keeps it for the command's time.
class WholeDeviceQueue {
 public:
  WholeDeviceQueue(cl_command_queue like, cl_int& error);
  ~WholeDeviceQueue();
  WholeDeviceQueue(const WholeDeviceQueue&) = delete;
  WholeDeviceQueue& operator=(const WholeDeviceQueue&) = delete;
  cl_command_queue get() const { return queue_; }

 private:
  cl_command_queue queue_ = nullptr;
};

/// What the program sees as the command's type, though the driver's event is an empty command's.
void set_command_type(const cl_event* event, cl_command_type type);

/// A command of the program's queue that does nothing, after what any command would wait for there.
/// PoCL's markers wait for the whole queue even if they have a list, so an out-of-order queue gets
/// a native kernel.
cl_int enqueue_nothing(cl_command_queue queue, cl_uint count, const cl_event* waits,
                       cl_event* event);

/// The waits of an image command: its own, and `start`.
std::vector<cl_event> with_start(const Enqueue& e, cl_event start);

/// Enqueues an image command. `call(queue, count, waits, event)` is the driver's, not blocking.
template <typename Call>
cl_int enqueue_image(const Enqueue& e, cl_command_type type, const timeline::Command& command,
                     Call&& call) {
  const cl_int result = enqueue(e, command, [&](cl_event* event) {
    cl_int error = CL_SUCCESS;
    const WholeDeviceQueue whole(e.queue, error);
    if (error != CL_SUCCESS) return error;
    cl_event start = nullptr, done = nullptr;
    error = enqueue_nothing(e.queue, 0, nullptr, &start);
    if (error != CL_SUCCESS) return error;
    const std::vector<cl_event> waits = with_start(e, start);
    error = call(whole.get(), static_cast<cl_uint>(waits.size()), waits.data(), &done);
    if (error == CL_SUCCESS) {
      error = enqueue_nothing(e.queue, 1, &done, event);
      target().clReleaseEvent(done);
    }
    target().clReleaseEvent(start);
    return error;
  });
  if (result == CL_SUCCESS) set_command_type(e.event, type);
  return result;
}

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_WHOLE_DEVICE_H
