// Fusion as an outline (host/tasks/outline.h): visual-inertial odometry on a host processor, which
// puts the window's poses and the inertial samples together.
#ifndef PARTITA_HOST_TASKS_FUSION_OUTLINE_H
#define PARTITA_HOST_TASKS_FUSION_OUTLINE_H

#include "host/tasks/program.h"

namespace partita::fusion {

tasks::TaskExport outline(const tasks::Sensors& sensors);

}  // namespace partita::fusion

#endif  // PARTITA_HOST_TASKS_FUSION_OUTLINE_H
