// A bundle adjustment problem: cameras, points and where the ones see the others.
#ifndef PARTITA_HOST_TASKS_BACKEND_PROBLEM_H
#define PARTITA_HOST_TASKS_BACKEND_PROBLEM_H

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace partita::backend {

/// `bal`: nine parameters a camera, as Bundle Adjustment in the Large has them. `stereo`: six (a
/// pose), three residuals an observation, the rectified rig's intrinsics given.
enum class CameraModel { bal, stereo };
std::string_view to_string(CameraModel model);

struct StereoRig {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  double baseline = 0;                    ///< metres
};

/// Angle-axis of R_cam_world (3), translation of T_cam_world (3); for BAL f, k1, k2.
using Camera = std::array<double, 9>;
using Point = std::array<double, 3>;  ///< in the world

struct Observation {
  int camera = 0, point = 0;
  /// bal: x, y from the picture's centre, y upwards. stereo: u_left, v, u_right.
  std::array<double, 3> measured{};
  double weight = 1;  ///< residuals are multiplied by it before the loss: 1 / standard deviation
};

struct Problem {
  CameraModel model = CameraModel::bal;
  StereoRig rig;  ///< stereo only
  std::vector<Camera> cameras;
  std::vector<Point> points;
  std::vector<Observation> observations;
  std::vector<bool> fixed;  ///< cameras that stay where they are; empty: none
};

enum class Loss { none, huber, cauchy };  ///< numbers as in projection.clh
std::string_view to_string(Loss loss);
/// Throws Error for anything but "none", "huber", "cauchy".
Loss parse_loss(std::string_view name);

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_PROBLEM_H
