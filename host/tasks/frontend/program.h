// The front-end's frame as data; see host/tasks/program.h.
#ifndef PARTITA_HOST_TASKS_FRONTEND_PROGRAM_H
#define PARTITA_HOST_TASKS_FRONTEND_PROGRAM_H

#include <span>

#include "host/tasks/frontend/frontend.h"
#include "host/tasks/program.h"

namespace partita::frontend {

/// Exactly what Frontend::process() makes its session do for a frame with these counts.
tasks::Program program(int width, int height, const FrontendParameters& parameters,
                       const FrameCounts& counts);

/// A frame in mid-sequence on a street, tracked at once: shares of what the grids hold, as the
/// built-in scenario has them on average.
FrameCounts typical_counts(int width, int height, const FrontendParameters& parameters);

/// The task with one program per entry of `frames`.
tasks::TaskExport export_task(int width, int height, const FrontendParameters& parameters,
                              std::span<const FrameCounts> frames);

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_PROGRAM_H
