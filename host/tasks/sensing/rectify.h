// Unrectified stereo cameras: from lenses with distortion and slightly turned against each other to
// the pair that StereoCalibration describes. On the host, in plain C++: bilinear, from a table.
#ifndef PARTITA_HOST_TASKS_SENSING_RECTIFY_H
#define PARTITA_HOST_TASKS_SENSING_RECTIFY_H

#include <array>
#include <cstdint>
#include <vector>

#include "host/tasks/sensing/frame.h"

namespace partita::sensing {

/// A pinhole camera with radial (k1, k2, k3) and tangential (p1, p2) distortion, as OpenCV's
/// calibration gives it: x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2), and
/// likewise y' with p1 and p2 exchanged.
struct RawCamera {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 5> distortion{};  ///< k1, k2, p1, p2, k3
  int width = 0, height = 0;

  Eigen::Vector2d project(const Eigen::Vector3d& ray) const;
};

/// Where each pixel of the rectified picture comes from.
class RectifyMap {
 public:
  /// `R_rect_raw` takes a ray of the raw camera's axes to the rectified one's.
  RectifyMap(const RawCamera& raw, const Eigen::Matrix3d& R_rect_raw,
             const StereoCalibration& rectified);
  /// Throws Error where the picture is not of the raw camera's size. Pixels that the raw camera
  /// does not see are black.
  GrayImage apply(const GrayImage& raw) const;

 private:
  int raw_width_, raw_height_, width_, height_;
  struct Source {
    std::int32_t at = -1;        ///< offset of the upper left of four pixels; -1: outside
    std::uint16_t x = 0, y = 0;  ///< weights of the right and lower ones, 1/256
  };
  std::vector<Source> sources_;
};

/// Rectifying rotations of both cameras and the calibration that results: rows parallel to the base
/// line, the mean of both optical axes as the new one (Fusiello et al., "A compact algorithm for
/// rectification of stereo pairs", 2000), the pictures' centres kept.
struct Rectification {
  Eigen::Matrix3d R_rect_left, R_rect_right;
  StereoCalibration calibration;
};
Rectification rectify(const RawCamera& left, const RawCamera& right, const Pose& T_left_right);

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_RECTIFY_H
