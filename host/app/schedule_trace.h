// A schedule as a trace: one lane per engine, on the virtual clock.
#ifndef PARTITA_HOST_APP_SCHEDULE_TRACE_H
#define PARTITA_HOST_APP_SCHEDULE_TRACE_H

#include <string>

#include "devices/timeline/schedule.h"
#include "host/app/console.h"
#include "host/io/trace.h"

namespace partita::app {

/// What a lane shows: the command's name, or its kind if it has none.
std::string name_of(const timeline::Record& record, const timeline::RecordedCommand& command);
/// What is shown beside it.
Json details(const timeline::Record& record, const timeline::RecordedCommand& command);

void write_schedule(io::TraceWriter& trace, const std::string& machine,
                    const timeline::Record& record, const timeline::Schedule& schedule);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_SCHEDULE_TRACE_H
