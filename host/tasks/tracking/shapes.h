// The shapes of the tracking task's launches: what it launches with, and what its program states.
#ifndef PARTITA_HOST_TASKS_TRACKING_SHAPES_H
#define PARTITA_HOST_TASKS_TRACKING_SHAPES_H

#include "host/runtime/shape.h"
#include "host/tasks/tracking/golden.h"

namespace partita::tracking {

inline runtime::Shape resample_shape(Picture size, int cells, std::int64_t patches,
                                     std::int64_t samples) {
  return {{"width", size.width},
          {"height", size.height},
          {"cells", cells},
          {"patches", patches},
          {"samples", samples}};
}
inline runtime::Shape patches_shape(int cells, std::int64_t patches) {
  return {{"cells", cells}, {"patches", patches}};
}
inline runtime::Shape planes_shape(int cells, std::int64_t planes) {
  return {{"cells", cells}, {"planes", planes}};
}
inline runtime::Shape scales_shape(int cells, std::int64_t patches, int scales) {
  return patches_shape(cells, patches).with("scales", scales);
}
inline runtime::Shape train_shape(int cells, std::int64_t targets) {
  return {{"cells", cells}, {"targets", targets}};
}
inline runtime::Shape locate_shape(std::int64_t targets, std::int64_t patches) {
  return {{"targets", targets}, {"patches", patches}};
}
inline runtime::Shape associate_shape(std::int64_t targets, std::int64_t detections) {
  return {{"targets", targets}, {"detections", detections}};
}

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_SHAPES_H
