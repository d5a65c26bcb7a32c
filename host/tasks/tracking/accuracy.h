// How well one object was tracked: the measures of the OTB benchmark (Wu, Lim, Yang, "Object
// Tracking Benchmark", TPAMI 2015).
#ifndef PARTITA_HOST_TASKS_TRACKING_ACCURACY_H
#define PARTITA_HOST_TASKS_TRACKING_ACCURACY_H

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "host/tasks/tracking/box.h"

namespace partita::tracking {

inline constexpr double kPrecisionRadius = 20;  ///< px

struct Accuracy {
  std::size_t frames = 0;   ///< with truth
  double mean_overlap = 0;  ///< intersection over union
  double precision = 0;     ///< share of frames with centres at most kPrecisionRadius apart
};

/// Over the frames that have truth; one without a box counts as missed.
inline Accuracy measure(const std::vector<std::optional<Box>>& boxes,
                        const std::vector<std::optional<Box>>& truth) {
  Accuracy accuracy;
  std::size_t near = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    if (!truth[k]) continue;
    ++accuracy.frames;
    if (k >= boxes.size() || !boxes[k]) continue;
    accuracy.mean_overlap += overlap(*boxes[k], *truth[k]);
    near += std::hypot(boxes[k]->centre_x() - truth[k]->centre_x(),
                       boxes[k]->centre_y() - truth[k]->centre_y()) <= kPrecisionRadius;
  }
  if (accuracy.frames == 0) return accuracy;
  accuracy.mean_overlap /= static_cast<double>(accuracy.frames);
  accuracy.precision = static_cast<double>(near) / static_cast<double>(accuracy.frames);
  return accuracy;
}

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_ACCURACY_H
