// Planning as an outline (host/tasks/outline.h): model-predictive control on a lane-level map.
#ifndef PARTITA_HOST_TASKS_PLANNING_OUTLINE_H
#define PARTITA_HOST_TASKS_PLANNING_OUTLINE_H

#include "host/tasks/program.h"

namespace partita::planning {

tasks::TaskExport outline(const tasks::Sensors& sensors);

}  // namespace partita::planning

#endif  // PARTITA_HOST_TASKS_PLANNING_OUTLINE_H
