// Sensing as an outline (host/tasks/outline.h): two stereo pairs and the inertial samples between
// two frames, synchronised and handed on by the processor that the sensors are wired to.
#ifndef PARTITA_HOST_TASKS_SENSING_OUTLINE_H
#define PARTITA_HOST_TASKS_SENSING_OUTLINE_H

#include "host/tasks/program.h"

namespace partita::sensing {

tasks::TaskExport outline(const tasks::Sensors& sensors);

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_OUTLINE_H
