// A network's run, and the detection task's frame, as data; see host/tasks/program.h.
#ifndef PARTITA_HOST_TASKS_DETECTION_PROGRAM_H
#define PARTITA_HOST_TASKS_DETECTION_PROGRAM_H

#include "host/tasks/detection/plan.h"
#include "host/tasks/program.h"

namespace partita::detection {

/// Exactly what DarknetNetwork::run() makes its session do.
void add_network(tasks::Program& program, const Plan& plan);

/// YOLOv3 at 416 x 416, with a street's typical number of boxes: a run does not execute it yet.
tasks::TaskExport export_task(const tasks::Sensors& sensors);

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_PROGRAM_H
