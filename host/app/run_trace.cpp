// trace.json of a run.
#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "host/app/run.h"
#include "host/app/schedule_trace.h"
#include "host/io/trace.h"

namespace partita::app {
namespace {

using timeline::RecordedCommand;

class MeasuredTrace {
 public:
  MeasuredTrace(io::TraceWriter& trace, const RunReport& report)
      : trace_(trace), report_(report), process_(trace.process("measured (wall time here)")) {
    for (const BranchRun& branch : report.run.branches) {
      if (!branch.frames.empty()) zero_ = std::min(zero_, branch.frames.front().start);
    }
  }

  /// Whole frames, one lane per host thread.
  void write_frames() {
    for (const Branch branch : partition::kBranches) {
      const auto lane = trace_.lane(process_, fmt::format("host: {}", to_string(branch)));
      for (const WallFrame& frame : report_.run.of(branch).frames) {
        write(lane, fmt::format("frame {}", frame.frame), to_string(branch), frame.start, frame.end,
              {});
      }
    }
  }

  /// What the devices here really executed, one lane per queue: its commands cannot overlap.
  void write_commands(const timeline::Record& record) {
    std::map<timeline::QueueId, io::TraceWriter::Lane> lanes;
    for (const RecordedCommand& command : record.commands) {
      if (command.queue == timeline::kNone || command.measured_end == 0) continue;
      if (!lanes.contains(command.queue)) {
        const auto& device = record.layout.devices[record.queues[command.queue].device];
        lanes[command.queue] = trace_.lane(
            process_, fmt::format("{} queue {} (executed here)", device.name, command.queue));
      }
      write(lanes[command.queue], name_of(record, command), record.names[command.task],
            command.measured_start, command.measured_end, details(record, command));
    }
  }

 private:
  void write(io::TraceWriter::Lane lane, const std::string& name, std::string_view category,
             std::uint64_t start, std::uint64_t end, const Json& args) {
    trace_.complete(lane, name, category, static_cast<std::int64_t>(start - zero_),
                    static_cast<std::int64_t>(end - start), args);
  }

  io::TraceWriter& trace_;
  const RunReport& report_;
  int process_;
  std::uint64_t zero_ = std::numeric_limits<std::uint64_t>::max();
};

}  // namespace

void write_run_trace(const std::string& path, const RunReport& report) {
  io::TraceWriter trace(path);
  if (const auto& predicted = report.prediction) {
    write_schedule(trace, predicted->machine.id, predicted->record, predicted->schedule);
  }
  MeasuredTrace measured(trace, report);
  measured.write_frames();
  if (report.prediction) measured.write_commands(report.prediction->record);
  trace.close();
}

}  // namespace partita::app
