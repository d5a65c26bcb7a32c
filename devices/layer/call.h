// What every entry point needs: no exception leaves it, and the calling thread has a clock.
#ifndef PARTITA_DEVICES_LAYER_CALL_H
#define PARTITA_DEVICES_LAYER_CALL_H

#include <exception>
#include <new>

#include "devices/layer/state.h"

namespace partita::layer {

/// An internal error: told on stderr with PARTITA_VERBOSE, and CL_OUT_OF_RESOURCES to the program.
cl_int report(const std::exception& error) noexcept;

/// Runs the body of an entry point that returns an error code.
template <typename Body>
cl_int guarded(Body&& body) noexcept {
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return CL_OUT_OF_HOST_MEMORY;
  } catch (const std::exception& error) {
    return report(error);
  }
}

/// Runs the body of an entry point that returns a handle: body(cl_int& error) -> Handle.
template <typename Handle, typename Body>
Handle guarded_object(cl_int* errcode_ret, Body&& body) noexcept {
  cl_int error = CL_SUCCESS;
  Handle handle = nullptr;
  try {
    handle = body(error);
  } catch (const std::bad_alloc&) {
    error = CL_OUT_OF_HOST_MEMORY;
  } catch (const std::exception& e) {
    error = report(e);
  }
  if (errcode_ret) *errcode_ret = error;
  return handle;
}

/// The calling thread's id on the timeline, made at its first call. state().mutex is held.
timeline::ThreadId current_thread();

/// The machine's node on which the calling thread runs: the main node until it is bound elsewhere.
std::uint32_t current_node();
void set_current_node(std::uint32_t node);

/// While it lives, the calling thread acts as `thread`: a callback runs at its event's time.
class ActAs {
 public:
  explicit ActAs(timeline::ThreadId thread);
  ~ActAs();
  ActAs(const ActAs&) = delete;
  ActAs& operator=(const ActAs&) = delete;

 private:
  timeline::ThreadId before_;
};

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_CALL_H
