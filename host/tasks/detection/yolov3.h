// YOLOv3, as its public network description (yolov3.cfg) has it.
#ifndef PARTITA_HOST_TASKS_DETECTION_YOLOV3_H
#define PARTITA_HOST_TASKS_DETECTION_YOLOV3_H

#include "host/io/darknet.h"

namespace partita::detection {

/// 416 x 416, 80 classes.
io::darknet::Model yolov3();

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_YOLOV3_H
