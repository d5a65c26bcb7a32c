#include "devices/layer/call.h"

namespace partita::layer {
namespace {

/// A host thread's place on the timeline, given back when the thread ends.
struct HostThread {
  timeline::ThreadId id = timeline::kNone;
  timeline::ThreadId acting = timeline::kNone;
  std::uint32_t node = timeline::kNone;

  ~HostThread() {
    if (id == timeline::kNone) return;
    try {
      const Lock lock(state().mutex);
      state().timeline->remove_thread(id);
    } catch (const std::exception& error) {
      report(error);
    }
  }
};

thread_local HostThread host_thread;

}  // namespace

cl_int report(const std::exception& error) noexcept {
  try {
    say_once(std::string("internal: ") + error.what());
  } catch (...) {
    return CL_OUT_OF_HOST_MEMORY;
  }
  return CL_OUT_OF_RESOURCES;
}

timeline::ThreadId current_thread() {
  if (host_thread.acting != timeline::kNone) return host_thread.acting;
  if (host_thread.id == timeline::kNone) host_thread.id = state().timeline->add_thread("");
  return host_thread.id;
}

std::uint32_t current_node() {
  const bool bound = host_thread.node != timeline::kNone && host_thread.acting == timeline::kNone;
  return bound ? host_thread.node : state().machine.main_node;
}

void set_current_node(std::uint32_t node) {
  host_thread.node = node;
}

ActAs::ActAs(timeline::ThreadId thread) : before_(host_thread.acting) {
  host_thread.acting = thread;
}

ActAs::~ActAs() {
  host_thread.acting = before_;
}

}  // namespace partita::layer
