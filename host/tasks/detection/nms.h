// Non-maximum suppression: of boxes that overlap too much, the best one stays.
#ifndef PARTITA_HOST_TASKS_DETECTION_NMS_H
#define PARTITA_HOST_TASKS_DETECTION_NMS_H

#include <cstddef>
#include <vector>

#include "host/tasks/detection/decode.h"

namespace partita::detection {

struct Suppressed {
  std::vector<Detection> kept;
  std::size_t compared = 0;  ///< pairs whose overlap was asked for
};

/// Goes through the detections by falling score (of equal ones the earlier first) and keeps each
/// whose IoU with every one kept of its class is at most `overlap`. Returns the kept ones in that
/// order. What is kept above some score does not depend on detections below it.
Suppressed suppress(std::vector<Detection> detections, double overlap);

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_NMS_H
