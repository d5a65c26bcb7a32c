// A sliding window of stereo key-frames for bundle adjustment: the last poses, at most 50, and the
// landmarks that they see.
//
// The oldest poses of the window are held fixed. That keeps the gauge (a stereo window is free to
// move as a whole) and ties the window to the path behind it, and it is consistent at any
// linearisation: marginalising the poses that leave would carry a prior whose Jacobians are taken
// where those poses were, and which fills the reduced system. What it costs: the uncertainty of
// the fixed poses is ignored, and what their leaving observations knew is kept only in the
// landmarks' values.
#ifndef PARTITA_HOST_TASKS_BACKEND_WINDOW_H
#define PARTITA_HOST_TASKS_BACKEND_WINDOW_H

#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "host/tasks/backend/solver.h"

namespace partita::backend {

/// A landmark in a key-frame's left and right picture, in pixels.
struct StereoSighting {
  std::int64_t landmark = 0;
  double u_left = 0, v = 0, u_right = 0;
  double sigma = 1;  ///< standard deviation, pixels
};

struct WindowOptions {
  int poses = 10;  ///< 2 to 50
  int fixed = 1;   ///< of the oldest ones, once there are more
  /// Pixels; a landmark is placed by its first sighting, and not at all if it is further away.
  double least_disparity = 0.5;
};

class Window {
 public:
  static constexpr int kMostPoses = 50;

  /// Throws Error for options out of range.
  Window(const StereoRig& rig, const WindowOptions& options);

  /// Appends a key-frame with its pose as far as it is known. The oldest leaves if there are too
  /// many, and with it the landmarks that no other sees. Sightings without disparity are left out;
  /// so are a landmark's further ones in the same key-frame.
  void add(const Eigen::Isometry3d& T_world_cam, std::span<const StereoSighting> sightings);

  /// Adjusts poses and landmarks. A window of one pose, or of landmarks that no two poses see,
  /// stays as it is: the summary then has no iteration.
  Summary adjust(const BundleAdjuster& adjuster, const SolverOptions& options);

  int poses() const { return static_cast<int>(frames_.size()); }
  std::size_t landmarks() const { return landmarks_.size(); }
  /// Of the window's i-th key-frame, the oldest first.
  const Eigen::Isometry3d& T_world_cam(int i) const {
    return frames_[static_cast<std::size_t>(i)].T_world_cam;
  }
  /// The problem that adjust() solves.
  Problem problem() const;

 private:
  struct Frame {
    Eigen::Isometry3d T_world_cam;
    std::vector<StereoSighting> sightings;
  };
  struct Landmark {
    Eigen::Vector3d position;  ///< in the world
    int seen = 0;              ///< sightings in the window
  };
  void drop_oldest();

  StereoRig rig_;
  WindowOptions options_;
  std::deque<Frame> frames_;
  std::map<std::int64_t, Landmark> landmarks_;
};

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_WINDOW_H
