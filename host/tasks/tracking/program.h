// The tracking task's frame as data; see host/tasks/program.h.
#ifndef PARTITA_HOST_TASKS_TRACKING_PROGRAM_H
#define PARTITA_HOST_TASKS_TRACKING_PROGRAM_H

#include <span>

#include "host/tasks/program.h"
#include "host/tasks/tracking/tracker.h"

namespace partita::tracking {

/// Exactly what Tracker::update() makes its session do for a frame with these counts.
tasks::Program program(int width, int height, const FilterParameters& parameters,
                       const FrameCounts& counts);

/// A frame of a street: ten targets, twenty detections, windows about twice as large as the
/// template.
FrameCounts typical_counts(const FilterParameters& parameters);

/// The task with one program per entry of `frames`.
tasks::TaskExport export_task(int width, int height, const FilterParameters& parameters,
                              std::span<const FrameCounts> frames);

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_PROGRAM_H
