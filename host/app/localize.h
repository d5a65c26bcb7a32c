// What `partita localize` was asked and what came of it; see localize_command.cpp.
#ifndef PARTITA_HOST_APP_LOCALIZE_H
#define PARTITA_HOST_APP_LOCALIZE_H

#include <optional>
#include <string>
#include <vector>

#include "host/app/console.h"
#include "host/io/trajectory.h"
#include "host/io/trajectory_error.h"
#include "host/tasks/fusion/drive.h"
#include "host/tasks/sensing/dataset.h"

namespace partita::app {

struct LocalizeOptions {
  std::string dataset;  ///< empty: the built-in scenario
  sensing::ScenarioOptions scenario;
  std::string out = "partita-localize";
  std::string truth;  ///< TUM or KITTI file; empty: the data set's own
  bool force = false;
  bool no_gps = false, no_imu = false, no_vision = false, no_wheels = false;
  bool positions_only = false;
  std::vector<std::string> gps_gaps;  ///< START:SECONDS
  double gap_test = 0;                ///< seconds; 0: none
  std::size_t frames = 0;             ///< 0: all
  std::size_t window = 0;             ///< 0: the default
};

/// A trajectory of one pose per moment and what is known of its truth at the same moments.
struct Compared {
  io::Trajectory estimate, truth;
  std::optional<io::TrajectoryError> error;
  std::optional<io::RelativeError> relative;
};

struct LocalizeReport {
  const LocalizeOptions& options;
  const sensing::Dataset& dataset;
  fusion::DriveResult drive;
  std::vector<std::int64_t> times;
  io::Trajectory poses;  ///< T_world_cam with pictures, T_world_imu without
  Compared fused, vision;
  std::size_t frames = 0, frames_lost = 0;
  double vision_seconds = 0, fusion_seconds = 0;
  std::vector<fusion::GapError> gaps;
  std::vector<std::string> files;
};

/// The true poses of the body that `poses` are of at these times, interpolated; empty entries where
/// the truth does not reach.
std::vector<std::optional<Eigen::Isometry3d>> truth_at(const std::vector<sensing::TimedPose>& truth,
                                                       const std::vector<std::int64_t>& times,
                                                       const Eigen::Isometry3d& T_imu_body);

/// The comparison over the moments of which both are known.
Compared compare(const io::Trajectory& poses,
                 const std::vector<std::optional<Eigen::Isometry3d>>& truth);

Json to_json(const LocalizeReport& report);
std::string to_text(const LocalizeReport& report);

/// path.svg and path.png: the path from above, over the truth and the fixes.
void write_path_plot(const std::string& folder, const LocalizeReport& report);
/// fixes.csv: each fix, where the vehicle was expected, and what became of it.
void write_fixes(const std::string& path, const LocalizeReport& report);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_LOCALIZE_H
