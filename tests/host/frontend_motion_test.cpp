// The motion from matches: exact data give the exact motion, outliers do not matter, too few
// matches leave the prediction.
#include <gtest/gtest.h>

#include "host/tasks/frontend/cases.h"
#include "host/tasks/frontend/motion.h"

namespace partita::frontend {
namespace {

const StereoCalibration kCalibration{700, 700, 600, 180, 0.5, 1200, 360};

Pose some_motion() {
  Pose motion = Pose::Identity();
  motion.linear() = Eigen::AngleAxisd(0.02, Eigen::Vector3d(0.1, 1, -0.2).normalized()).matrix();
  motion.translation() = Eigen::Vector3d(0.05, -0.02, -1.2);
  return motion;
}

std::vector<Observation> observations_of(const Pose& motion, int count, int outlier_every) {
  Random random(11);
  std::vector<Observation> observations;
  for (int i = 0; i < count; ++i) {
    const double z = random.between(40, 600) / 10.0;
    const Eigen::Vector3d point(random.between(-70, 70) / 100.0 * z,
                                random.between(-20, 20) / 100.0 * z, z);
    const Eigen::Vector3d p = motion * point;
    Eigen::Vector2d pixel(700 * p.x() / p.z() + 600, 700 * p.y() / p.z() + 180);
    if (outlier_every > 0 && i % outlier_every == 0) {
      pixel += Eigen::Vector2d(random.between(5, 90), random.between(-60, -5));
    }
    observations.push_back({point, pixel});
  }
  return observations;
}

TEST(FrontendMotion, ExactMatchesGiveTheExactMotion) {
  const auto observations = observations_of(some_motion(), 100, 0);
  const auto estimate = estimate_motion(observations, kCalibration, Pose::Identity(), {});
  EXPECT_EQ(estimate.inlier_count, 100);
  EXPECT_LT((estimate.T_current_reference.matrix() - some_motion().matrix()).norm(), 1e-5);
}

TEST(FrontendMotion, AThirdOfOutliersIsFound) {
  const auto observations = observations_of(some_motion(), 150, 3);
  const auto estimate = estimate_motion(observations, kCalibration, Pose::Identity(), {});
  EXPECT_EQ(estimate.inlier_count, 100);
  EXPECT_FALSE(estimate.inliers[0]);
  EXPECT_TRUE(estimate.inliers[1]);
  EXPECT_LT((estimate.T_current_reference.matrix() - some_motion().matrix()).norm(), 1e-4);
}

TEST(FrontendMotion, TheSameMatchesGiveTheSameBits) {
  const auto observations = observations_of(some_motion(), 90, 4);
  const auto first = estimate_motion(observations, kCalibration, Pose::Identity(), {});
  const auto second = estimate_motion(observations, kCalibration, Pose::Identity(), {});
  EXPECT_EQ(first.T_current_reference.matrix(), second.T_current_reference.matrix());
}

TEST(FrontendMotion, TooFewMatchesLeaveThePrediction) {
  const auto observations = observations_of(some_motion(), 2, 0);
  const auto estimate = estimate_motion(observations, kCalibration, some_motion(), {});
  EXPECT_EQ(estimate.inlier_count, 0);
  EXPECT_EQ(estimate.T_current_reference.matrix(), some_motion().matrix());
}

TEST(FrontendMotion, PointsBehindTheCameraAreNoInliers) {
  std::vector<Observation> observations(50, {Eigen::Vector3d(0, 0, -5), Eigen::Vector2d(600, 180)});
  const auto estimate = estimate_motion(observations, kCalibration, Pose::Identity(), {});
  EXPECT_EQ(estimate.inlier_count, 0);
}

TEST(FrontendMotion, AMotionDoneTwiceIsHalvedAgain) {
  const Pose twice = scaled_motion(some_motion(), 2);
  const Pose again = scaled_motion(twice, 0.5);
  EXPECT_LT((again.matrix() - some_motion().matrix()).norm(), 1e-12);
}

}  // namespace
}  // namespace partita::frontend
