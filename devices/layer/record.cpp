#include "devices/layer/record.h"

#include <cstdlib>

#include "devices/timeline/record.h"

namespace partita::layer {
namespace {

constexpr std::size_t kBatch = 1024;  ///< commands between two harvests

struct Measured {
  cl_event event = nullptr;
  timeline::NodeId node = timeline::kNone;
};

/// Guarded by state().mutex.
struct Waiting {
  std::vector<Measured> commands;
  std::size_t harvest_at = kBatch;
};
Waiting& waiting() {
  static auto* const list = new Waiting;
  return *list;
}

cl_ulong profiled(cl_event event, cl_profiling_info name) {
  cl_ulong ns = 0;
  target().clGetEventProfilingInfo(event, name, sizeof ns, &ns, nullptr);
  return ns;
}

cl_int status_of(cl_event event) {
  cl_int status = CL_COMPLETE;
  target().clGetEventInfo(event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status,
                          nullptr);
  return status;
}

}  // namespace

void measure(cl_event event, timeline::NodeId node) {
  bool full = false;
  {
    const Lock lock(state().mutex);
    state().timeline->retain(node);
    waiting().commands.push_back({event, node});
    full = waiting().commands.size() >= waiting().harvest_at;
  }
  if (full) harvest();
}

void harvest() {
  std::vector<Measured> commands;
  {
    const Lock lock(state().mutex);
    commands.swap(waiting().commands);
  }
  std::vector<Measured> running;
  struct Time {
    timeline::NodeId node;
    cl_ulong start, end;
  };
  std::vector<Time> times;
  for (const Measured& m : commands) {
    const cl_int status = status_of(m.event);
    if (status > CL_COMPLETE) {
      running.push_back(m);
      continue;
    }
    times.push_back({m.node, 0, 0});
    if (status == CL_COMPLETE) {
      times.back().start = profiled(m.event, CL_PROFILING_COMMAND_START);
      times.back().end = profiled(m.event, CL_PROFILING_COMMAND_END);
    }
    target().clReleaseEvent(m.event);
  }
  const Lock lock(state().mutex);
  for (const Time& t : times) {
    if (t.end) state().timeline->set_measured(t.node, t.start, t.end);
    state().timeline->release(t.node);
  }
  auto& list = waiting().commands;
  list.insert(list.end(), running.begin(), running.end());
  waiting().harvest_at = list.size() + kBatch;
}

cl_int export_record(const std::string& path) {
  State& s = state();
  if (!s.recording || !s.timeline) return CL_INVALID_OPERATION;
  harvest();
  try {
    timeline::Record record;
    {
      const Lock lock(s.mutex);
      record = s.timeline->snapshot();
    }
    timeline::save_record(record, path);
    if (record.racing()) say_once("several threads enqueued: only replayed times count");
  } catch (const std::exception& error) {
    say(error.what());
    return CL_OUT_OF_RESOURCES;
  }
  return CL_SUCCESS;
}

void write_record_at_exit() {
  const char* path = std::getenv("PARTITA_RECORD");
  if (!path || !*path) return;
  static auto* const target_path = new std::string(path);
  std::atexit([] { export_record(*target_path); });
}

}  // namespace partita::layer
