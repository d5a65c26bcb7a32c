// What a frame of tracking came to: its cost follows from it.
#ifndef PARTITA_HOST_TASKS_TRACKING_COUNTS_H
#define PARTITA_HOST_TASKS_TRACKING_COUNTS_H

#include <cstdint>

namespace partita::tracking {

struct FrameCounts {
  std::int64_t located = 0;         ///< targets looked for
  std::int64_t locate_samples = 0;  ///< bilinear samples of their patches, all scales
  bool detected = false;    ///< there were detections to associate, perhaps none of them any
  std::int64_t tracks = 0;  ///< that the detections were associated with
  std::int64_t detections = 0;
  std::int64_t trained = 0;  ///< targets whose filters were trained
  std::int64_t train_samples = 0;

  bool operator==(const FrameCounts&) const = default;
};

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_COUNTS_H
