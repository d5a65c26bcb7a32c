#include "host/app/schedule_trace.h"

#include <vector>

#include "host/app/explore.h"

namespace partita::app {

using timeline::RecordedCommand;

std::string name_of(const timeline::Record& record, const RecordedCommand& command) {
  const std::string& name = record.names[command.name];
  return name.empty() ? std::string(timeline::to_string(command.kind)) : name;
}

Json details(const timeline::Record& record, const RecordedCommand& command) {
  Json args;
  args["frame"] = command.frame;
  args["kind"] = timeline::to_string(command.kind);
  if (command.bytes > 0) args["bytes"] = command.bytes;
  if (command.work != timeline::kNone) {
    args["work"] = record.works[command.work].estimated != 0 ? "estimated" : "declared";
  }
  return args;
}

void write_schedule(io::TraceWriter& trace, const std::string& machine,
                    const timeline::Record& record, const timeline::Schedule& schedule) {
  const int process = trace.process("predicted (virtual time on " + machine + ")");
  std::vector<io::TraceWriter::Lane> lanes;
  for (const timeline::Engine& engine : schedule.engines) {
    lanes.push_back(trace.lane(process, engine.name));
  }
  for (const timeline::Occupation& part : schedule.occupations) {
    const RecordedCommand& command = record.commands[part.node];
    const timeline::Times& times = schedule.commands[part.node].times;
    Json args = details(record, command);
    args["queued_ns"] = times.queued;
    args["submit_ns"] = times.submit;
    trace.complete(lanes[part.engine], name_of(record, command), record.names[command.task],
                   static_cast<std::int64_t>(part.start),
                   static_cast<std::int64_t>(part.end - part.start), args);
  }
}

void write_schedule_trace(const std::string& path, const ExploreReport& report) {
  io::TraceWriter trace(path);
  write_schedule(trace, report.winner().machine, report.best->record, report.best->schedule);
  trace.close();
}

}  // namespace partita::app
