// Trajectories on disk: KITTI's rows and TUM's. The formatting is fixed, so that equal doubles give
// equal bytes.
#ifndef PARTITA_HOST_IO_TRAJECTORY_H
#define PARTITA_HOST_IO_TRAJECTORY_H

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace partita::io {

/// T_world_cam for each frame.
using Trajectory = std::vector<Eigen::Isometry3d>;

struct TimedTrajectory {
  std::vector<std::int64_t> timestamps_ns;
  Trajectory poses;
};

/// KITTI: one row of 12 numbers per pose, the upper 3x4 of T_world_cam row by row.
void write_kitti_trajectory(const std::string& path, const Trajectory& poses);

/// Reads such a file. Throws Error with file and line for a wrong number of columns, for what is
/// not a finite number, and for a 3x3 part that is not a rotation to within 1e-3.
Trajectory read_kitti_trajectory(const std::string& path);

/// TUM: "t tx ty tz qx qy qz qw" per pose, t in seconds with nine decimals, qw >= 0.
/// timestamps_ns and poses are of equal length.
void write_tum_trajectory(const std::string& path, const std::vector<std::int64_t>& timestamps_ns,
                          const Trajectory& poses);

/// Reads such a file; '#' begins a comment. Throws Error with file and line, also for a quaternion
/// whose length differs from 1 by more than 1e-3.
TimedTrajectory read_tum_trajectory(const std::string& path);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_TRAJECTORY_H
