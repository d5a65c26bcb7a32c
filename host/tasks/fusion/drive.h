// A recorded drive through the estimator: which moments get a state, what each of them knows, and
// how well a loss of GPS is bridged.
#ifndef PARTITA_HOST_TASKS_FUSION_DRIVE_H
#define PARTITA_HOST_TASKS_FUSION_DRIVE_H

#include <functional>
#include <span>
#include <vector>

#include "host/tasks/fusion/estimator.h"
#include "host/tasks/sensing/sensor_log.h"

namespace partita::fusion {

using sensing::SensorLog;

/// What vision made of a frame.
struct VisualFrame {
  std::int64_t timestamp_ns = 0;
  std::optional<VisualMotion> motion;   ///< nothing: the first frame, or the track was lost
  std::int64_t reference_ns = 0;        ///< the frame that the motion begins at
  Pose T_world_cam = Pose::Identity();  ///< by vision alone
};

/// Between these times (of the log's clock) no fix is used.
struct GpsGap {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
};

struct DriveResult {
  std::vector<NavState> states;  ///< as known at each moment, from then and before; in the map if
                                 ///< that became known
  std::vector<FixReport> fixes;
  EstimatorCounts counts;
  bool in_map = false;
  const char* origin = "";
  std::size_t moments = 0;  ///< states.size() of them were after the beginning
};

/// Without frames, moments are those of the fixes, and tenths of a second where there are none.
DriveResult localize(const SensorLog& log, std::span<const VisualFrame> frames,
                     const EstimatorOptions& options, std::span<const GpsGap> gaps = {},
                     const std::function<void(std::size_t, std::size_t)>& progress = {});

/// Options that fit a log: its noise, its wheels, whether it has inertial readings at all.
EstimatorOptions options_for(const SensorLog& log);

/// One loss of GPS: where the vehicle was thought to be when it returned, against the fix then.
struct GapError {
  std::int64_t from_ns = 0;  ///< the last fix before
  double seconds = 0;
  double error = 0;      ///< metres, horizontally
  double ahead = 0;      ///< of it, along the way between the two fixes: thought to be too far
  double left = 0;       ///< and across
  double sigmas = 0;     ///< in standard deviations, the fix's own among them
  double travelled = 0;  ///< between the two fixes, metres
};
/// Every gap of that length that can be cut, or every n-th: after each fix from which on the
/// estimate is in the map.
std::vector<GapError> all_gaps(const SensorLog& log, const EstimatorOptions& options,
                               double seconds, std::size_t every = 1,
                               const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace partita::fusion

#endif  // PARTITA_HOST_TASKS_FUSION_DRIVE_H
