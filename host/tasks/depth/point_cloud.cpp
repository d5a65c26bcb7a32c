#include "host/tasks/depth/point_cloud.h"

namespace partita::depth {

PointCloud point_cloud(const sensing::FloatImage& disparity, const sensing::GrayImage& left,
                       const sensing::PairCalibration& calibration) {
  const sensing::StereoCalibration& camera = calibration.camera;
  PointCloud cloud;
  for (int y = 0; y < disparity.height; ++y) {
    for (int x = 0; x < disparity.width; ++x) {
      if (!(disparity.at(x, y) > 0)) continue;
      const double d = disparity.at(x, y) + calibration.disparity_offset;
      if (d < kLeastCloudDisparity) {
        ++cloud.too_far;
        continue;
      }
      const double z = camera.fx * camera.baseline / d;
      cloud.points.push_back({static_cast<float>((x - camera.cx) * z / camera.fx),
                              static_cast<float>((y - camera.cy) * z / camera.fy),
                              static_cast<float>(z), left.at(x, y)});
    }
  }
  return cloud;
}

}  // namespace partita::depth
