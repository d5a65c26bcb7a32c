// How far an estimated trajectory is from the true one, by the three measures in use.
#ifndef PARTITA_HOST_IO_TRAJECTORY_ERROR_H
#define PARTITA_HOST_IO_TRAJECTORY_ERROR_H

#include <cstddef>
#include <optional>
#include <vector>

#include "host/io/trajectory.h"

namespace partita::io {

/// KITTI's segment errors (Geiger et al., "Are we ready for autonomous driving?", CVPR 2012, as its
/// development kit computes them): from every tenth frame, the relative motion over 100, 200, ...
/// 800 m of true path, estimated against true, divided by that length; then the mean of all.
struct SegmentError {
  double translation_percent = 0;        ///< t_rel
  double rotation_degrees_per_100m = 0;  ///< r_rel
  std::size_t segments = 0;              ///< how many the means are over, at least 1
};

struct TrajectoryError {
  double distance = 0;           ///< length of the true path, metres
  double end_error = 0;          ///< between the last positions, both seen from the first frame
  double end_error_percent = 0;  ///< of the distance; 0 where the vehicle stood still
  double ate_rmse = 0;           ///< absolute trajectory error, metres, see align()
  std::optional<SegmentError> segment;  ///< absent where the path is shorter than 100 m
};

/// The rigid motion (no scale) that takes `from` onto `onto` with the least sum of squared
/// distances (Umeyama, "Least-squares estimation of transformation parameters", 1991). Equal sizes,
/// >= 1.
Eigen::Isometry3d align(const std::vector<Eigen::Vector3d>& from,
                        const std::vector<Eigen::Vector3d>& onto);

/// Relative pose error between neighbouring poses (Sturm et al., "A benchmark for the evaluation of
/// RGB-D SLAM systems", IROS 2012): root mean square of what the estimated motion differs by.
struct RelativeError {
  double translation_rmse = 0;  ///< metres
  double rotation_rmse_degrees = 0;
};
/// Equal sizes, at least 2.
RelativeError relative_error(const Trajectory& estimate, const Trajectory& truth);

/// Both trajectories hold one pose per frame, in the same order. Throws Error when their lengths
/// differ or are 0.
TrajectoryError trajectory_error(const Trajectory& estimate, const Trajectory& truth);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_TRAJECTORY_ERROR_H
