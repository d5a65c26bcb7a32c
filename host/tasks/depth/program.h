// The depth task's frame as data; see host/tasks/program.h.
#ifndef PARTITA_HOST_TASKS_DEPTH_PROGRAM_H
#define PARTITA_HOST_TASKS_DEPTH_PROGRAM_H

#include <span>

#include "host/tasks/depth/depth.h"
#include "host/tasks/program.h"

namespace partita::depth {

/// Exactly what Depth::process() makes its session do for a frame with these counts.
tasks::Program program(int width, int height, const DepthParameters& parameters,
                       const FrameCounts& counts);

/// A frame of a street: shares of the support grid and of the picture, as the built-in scenario has
/// them on average.
FrameCounts typical_counts(int width, int height, const DepthParameters& parameters);

/// The task with one program per entry of `frames`.
tasks::TaskExport export_task(int width, int height, const DepthParameters& parameters,
                              std::span<const FrameCounts> frames);

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_PROGRAM_H
