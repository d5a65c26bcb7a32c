// A sliding window over a synthetic drive.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/runtime/error.h"
#include "host/tasks/backend/window.h"
#include "tests/kernels/kernel_tests.h"

namespace partita::backend {
namespace {

constexpr StereoRig kRig{700, 700, 600, 180, 0.54};

Eigen::Isometry3d true_pose(int frame) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const double yaw = 0.01 * frame;
  pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.4 * yaw * frame, 0, 0.8 * frame);
  return pose;
}

/// Landmarks along the street, seen with noise where they lie before the car.
class Street {
 public:
  explicit Street(std::uint32_t seed) : random_(seed) {
    for (int i = 0; i < 1500; ++i) {
      landmarks_.emplace_back(between(-15, 20), between(-4, 2), between(2, 70));
    }
  }
  std::vector<StereoSighting> look(const Eigen::Isometry3d& T_world_cam) {
    std::vector<StereoSighting> seen;
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      const Eigen::Vector3d p = T_world_cam.inverse() * landmarks_[i];
      if (p.z() < 3 || p.z() > 30) continue;
      const double u = kRig.fx * p.x() / p.z() + kRig.cx, v = kRig.fy * p.y() / p.z() + kRig.cy;
      if (u < 0 || u > 1226 || v < 0 || v > 370) continue;
      seen.push_back({static_cast<std::int64_t>(i), u + noise(), v + noise(),
                      u - kRig.fx * kRig.baseline / p.z() + noise(), 0.3});
    }
    return seen;
  }
  double between(double least, double most) {
    return least + (most - least) * (static_cast<double>(random_()) / 4294967296.0);
  }

 private:
  double noise() { return 0.3 * (between(-1, 1) + between(-1, 1) + between(-1, 1)); }
  std::mt19937 random_;
  std::vector<Eigen::Vector3d> landmarks_;
};

double drive(Window& window, const BundleAdjuster* adjuster, int frames) {
  Street street(4);
  Eigen::Isometry3d estimate = true_pose(0);
  for (int frame = 0; frame < frames; ++frame) {
    if (frame > 0) {  // odometry: the true motion with an error
      Eigen::Isometry3d motion = true_pose(frame - 1).inverse() * true_pose(frame);
      motion.translation().x() += street.between(-0.02, 0.04);
      motion.translation().z() += street.between(-0.02, 0.04);
      motion.rotate(Eigen::AngleAxisd(street.between(-0.002, 0.003), Eigen::Vector3d::UnitY()));
      estimate = window.T_world_cam(window.poses() - 1) * motion;
    }
    window.add(estimate, street.look(true_pose(frame)));
    SolverOptions options;
    options.loss = Loss::huber;
    options.loss_scale = 2;
    if (adjuster != nullptr) window.adjust(*adjuster, options);
  }
  const Eigen::Isometry3d& last = window.T_world_cam(window.poses() - 1);
  return (last.translation() - true_pose(frames - 1).translation()).norm();
}

TEST(BackendWindow, KeepsASyntheticDriveOnItsPath) {
  const runtime::Session session(tests::source_device(),
                                 kernels(CameraModel::stereo, Precision::full).list(),
                                 {.variant = runtime::Variant::cpu});
  const BundleAdjuster adjuster(session, CameraModel::stereo);
  Window alone(kRig, {.poses = 10}), adjusted(kRig, {.poses = 10});
  const double drift = drive(alone, nullptr, 40);
  const double error = drive(adjusted, &adjuster, 40);
  session.save_binaries();
  EXPECT_EQ(adjusted.poses(), 10);
  EXPECT_GT(drift, 0.3);
  EXPECT_LT(error, 0.1) << "without adjustment " << drift;
}

TEST(BackendWindow, ForgetsWhatNoPoseSees) {
  Window window(kRig, {.poses = 2});
  const std::vector<StereoSighting> first{{1, 600, 180, 580}, {2, 610, 180, 580}};
  const std::vector<StereoSighting> second{{2, 600, 180, 570}, {3, 600, 180, 599.9}, {2, 1, 1, 0}};
  window.add(Eigen::Isometry3d::Identity(), first);
  window.add(Eigen::Isometry3d::Identity(), second);
  EXPECT_EQ(window.landmarks(), 2u);  // the third has no disparity
  EXPECT_EQ(window.problem().observations.size(), 2u);
  window.add(Eigen::Isometry3d::Identity(), {});
  EXPECT_EQ(window.landmarks(), 1u);
  window.add(Eigen::Isometry3d::Identity(), {});
  EXPECT_EQ(window.landmarks(), 0u);
  EXPECT_EQ(window.poses(), 2);
}

TEST(BackendWindow, RefusesSizesOutOfRange) {
  EXPECT_THROW(Window(kRig, {.poses = 51}), Error);
  EXPECT_THROW(Window(kRig, {.poses = 1}), Error);
  EXPECT_THROW(Window(kRig, {.poses = 5, .fixed = 5}), Error);
  EXPECT_NO_THROW(Window(kRig, {.poses = 50, .fixed = 2}));
}

}  // namespace
}  // namespace partita::backend
