#include "host/tasks/detection/nms.h"

#include <algorithm>

namespace partita::detection {

Suppressed suppress(std::vector<Detection> detections, double overlap) {
  std::stable_sort(detections.begin(), detections.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  Suppressed result;
  for (const Detection& d : detections) {
    const auto hides = [&](const Detection& kept) {
      if (kept.object_class != d.object_class) return false;
      ++result.compared;
      return iou(kept.box, d.box) > overlap;
    };
    if (std::none_of(result.kept.begin(), result.kept.end(), hides)) result.kept.push_back(d);
  }
  return result;
}

}  // namespace partita::detection
