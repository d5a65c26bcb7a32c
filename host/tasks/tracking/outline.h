// Tracking as an outline (host/tasks/outline.h): a kernelized correlation filter (KCF) for each
// target, every frame, after detection.
#ifndef PARTITA_HOST_TASKS_TRACKING_OUTLINE_H
#define PARTITA_HOST_TASKS_TRACKING_OUTLINE_H

#include "host/tasks/program.h"

namespace partita::tracking {

tasks::TaskExport outline(const tasks::Sensors& sensors);

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_OUTLINE_H
