// Detection as an outline (host/tasks/outline.h): YOLOv3 at 416 x 416, layer by layer.
#ifndef PARTITA_HOST_TASKS_DETECTION_OUTLINE_H
#define PARTITA_HOST_TASKS_DETECTION_OUTLINE_H

#include "host/tasks/program.h"

namespace partita::detection {

tasks::TaskExport outline(const tasks::Sensors& sensors);

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_OUTLINE_H
