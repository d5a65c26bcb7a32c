#include "host/tasks/backend/window.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::backend {
namespace {

Camera to_camera(const Eigen::Isometry3d& T_world_cam) {
  const Eigen::Isometry3d T_cam_world = T_world_cam.inverse();
  const Eigen::AngleAxisd turn(Eigen::Quaterniond(T_cam_world.linear()).normalized());
  Camera camera{};
  for (int i = 0; i < 3; ++i) {
    camera[static_cast<std::size_t>(i)] = turn.angle() * turn.axis()[i];
    camera[static_cast<std::size_t>(3 + i)] = T_cam_world.translation()[i];
  }
  return camera;
}

Eigen::Isometry3d to_pose(const Camera& camera) {
  const Eigen::Vector3d w(camera[0], camera[1], camera[2]);
  const double angle = w.norm();
  Eigen::Isometry3d T_cam_world = Eigen::Isometry3d::Identity();
  if (angle > 0) T_cam_world.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  T_cam_world.translation() = Eigen::Vector3d(camera[3], camera[4], camera[5]);
  return T_cam_world.inverse();
}

}  // namespace

Window::Window(const StereoRig& rig, const WindowOptions& options) : rig_(rig), options_(options) {
  if (options.poses < 2 || options.poses > kMostPoses) {
    throw Error(fmt::format("window: {} poses, expected 2 to {}", options.poses, kMostPoses));
  }
  if (options.fixed < 1 || options.fixed >= options.poses) {
    throw Error(
        fmt::format("window: {} fixed poses, expected 1 to {}", options.fixed, options.poses - 1));
  }
}

void Window::add(const Eigen::Isometry3d& T_world_cam, std::span<const StereoSighting> sightings) {
  if (poses() == options_.poses) drop_oldest();
  Frame frame{T_world_cam, {}};
  std::map<std::int64_t, bool> here;
  for (const StereoSighting& s : sightings) {
    const double disparity = s.u_left - s.u_right;
    const bool finite = std::isfinite(s.u_left) && std::isfinite(s.v) && std::isfinite(disparity);
    if (!finite || !(disparity >= options_.least_disparity) || !(s.sigma > 0)) continue;
    if (!here.emplace(s.landmark, true).second) continue;
    const auto [landmark, is_new] = landmarks_.try_emplace(s.landmark);
    if (is_new) {
      const double z = rig_.fx * rig_.baseline / disparity;
      landmark->second.position = T_world_cam * Eigen::Vector3d((s.u_left - rig_.cx) * z / rig_.fx,
                                                                (s.v - rig_.cy) * z / rig_.fy, z);
    }
    ++landmark->second.seen;
    frame.sightings.push_back(s);
  }
  frames_.push_back(std::move(frame));
}

void Window::drop_oldest() {
  for (const StereoSighting& s : frames_.front().sightings) {
    const auto landmark = landmarks_.find(s.landmark);
    if (--landmark->second.seen == 0) landmarks_.erase(landmark);
  }
  frames_.pop_front();
}

Problem Window::problem() const {
  Problem problem;
  problem.model = CameraModel::stereo;
  problem.rig = rig_;
  std::map<std::int64_t, int> indices;  // of landmarks that two key-frames see
  for (const auto& [id, landmark] : landmarks_) {
    if (landmark.seen < 2) continue;
    indices[id] = static_cast<int>(problem.points.size());
    problem.points.push_back({landmark.position.x(), landmark.position.y(), landmark.position.z()});
  }
  for (const Frame& frame : frames_) {
    const int camera = static_cast<int>(problem.cameras.size());
    problem.cameras.push_back(to_camera(frame.T_world_cam));
    problem.fixed.push_back(camera < options_.fixed);
    const Eigen::Isometry3d T_cam_world = frame.T_world_cam.inverse();
    for (const StereoSighting& s : frame.sightings) {
      const auto index = indices.find(s.landmark);
      if (index == indices.end()) continue;
      // A landmark that this pose has behind it says nothing that could be trusted.
      if ((T_cam_world * landmarks_.at(s.landmark).position).z() <= 0) continue;
      problem.observations.push_back({.camera = camera,
                                      .point = index->second,
                                      .measured = {s.u_left, s.v, s.u_right},
                                      .weight = 1 / s.sigma});
    }
  }
  return problem;
}

Summary Window::adjust(const BundleAdjuster& adjuster, const SolverOptions& options) {
  Problem adjusted = problem();
  if (poses() <= options_.fixed || adjusted.observations.empty()) {
    Summary summary;
    summary.termination = "nothing to adjust";
    return summary;
  }
  const Summary summary = adjuster.solve(adjusted, options);
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!adjusted.fixed[i]) frames_[i].T_world_cam = to_pose(adjusted.cameras[i]);
  }
  std::size_t point = 0;
  for (auto& [id, landmark] : landmarks_) {
    if (landmark.seen < 2) continue;
    const Point& p = adjusted.points[point++];
    landmark.position = Eigen::Vector3d(p[0], p[1], p[2]);
  }
  return summary;
}

}  // namespace partita::backend
