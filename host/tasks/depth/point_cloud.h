// From disparities to points in space.
#ifndef PARTITA_HOST_TASKS_DEPTH_POINT_CLOUD_H
#define PARTITA_HOST_TASKS_DEPTH_POINT_CLOUD_H

#include <cstddef>
#include <vector>

#include "host/io/point_cloud.h"
#include "host/tasks/sensing/frame.h"
#include "host/tasks/sensing/stereo_calibration.h"

namespace partita::depth {

/// Below this disparity (offset included) depth is a guess: half a pixel more or less is a factor
/// of three.
inline constexpr double kLeastCloudDisparity = 1;

struct PointCloud {
  std::vector<io::CloudPoint> points;  ///< left camera's axes (x right, y down, z forward), metres
  std::size_t too_far = 0;             ///< pixels left out: below kLeastCloudDisparity
};

/// One point for each pixel that has a disparity, in order of row and column, with the level of
/// `left`. All pictures have one size.
PointCloud point_cloud(const sensing::FloatImage& disparity, const sensing::GrayImage& left,
                       const sensing::PairCalibration& calibration);

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_POINT_CLOUD_H
