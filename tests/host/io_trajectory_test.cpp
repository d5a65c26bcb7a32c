#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/io/file.h"
#include "host/io/trajectory.h"
#include "host/io/trajectory_error.h"
#include "tests/host/io_temp_folder.h"

namespace partita::io {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::TempFolder;

Eigen::Isometry3d pose(double yaw, double x, double z) {
  Eigen::Isometry3d p = Eigen::Isometry3d::Identity();
  p.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()).toRotationMatrix();
  p.translation() = Eigen::Vector3d(x, 0.1 * x, z);
  return p;
}

Trajectory curve(int count) {
  Trajectory poses;
  for (int i = 0; i < count; ++i) poses.push_back(pose(0.01 * i, std::sin(0.02 * i), i));
  return poses;
}

TEST(Trajectories, KittiRoundTrip) {
  const TempFolder folder;
  const Trajectory poses = curve(40);
  write_kitti_trajectory(folder.file("t.txt"), poses);
  const Trajectory read = read_kitti_trajectory(folder.file("t.txt"));
  ASSERT_EQ(read.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_TRUE(read[i].matrix().isApprox(poses[i].matrix(), 1e-12));
  }
}

TEST(Trajectories, TumRoundTripWithExactTimes) {
  const TempFolder folder;
  const Trajectory poses = {pose(3.0, 1, 2), pose(-3.1, 4, 5), pose(0, 0, 0)};
  const std::vector<std::int64_t> times = {0, 100'000'001, 12'345'678'901};
  write_tum_trajectory(folder.file("t.tum"), times, poses);
  const TimedTrajectory read = read_tum_trajectory(folder.file("t.tum"));
  EXPECT_EQ(read.timestamps_ns, times);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_TRUE(read.poses[i].matrix().isApprox(poses[i].matrix(), 1e-10));
  }
}

TEST(Trajectories, FormattingIsFixed) {
  const TempFolder folder;
  Trajectory poses = {Eigen::Isometry3d::Identity()};
  poses[0].translation() = Eigen::Vector3d(-0.0, 1.0 / 3.0, -2.5);
  write_kitti_trajectory(folder.file("t.txt"), poses);
  const std::string one = "1.000000000000e+00";
  const std::string zero = "0.000000000000e+00";
  EXPECT_EQ(read_file(folder.file("t.txt")),
            one + " " + zero + " " + zero + " " + zero + " " + zero + " " + one + " " + zero +
                " 3.333333333333e-01 " + zero + " " + zero + " " + one + " -2.500000000000e+00\n");
  write_tum_trajectory(folder.file("t.tum"), {1'500'000'000}, poses);
  EXPECT_EQ(read_file(folder.file("t.tum")), "1.500000000 " + zero +
                                                 " 3.333333333333e-01 -2.500000000000e+00 " + zero +
                                                 " " + zero + " " + zero + " " + one + "\n");
}

TEST(Trajectories, RefuseWithFileAndLine) {
  const TempFolder folder;
  const std::string good = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const auto kitti = [&](const std::string& second) {
    const std::string path = folder.write("t.txt", good + second);
    return error_of([&] { read_kitti_trajectory(path); });
  };
  EXPECT_THAT(kitti("1 0 0 0 0 1 0 0 0 0 1\n"), HasSubstr("t.txt:2: 11 numbers"));
  EXPECT_THAT(kitti("1 0 0 nan 0 1 0 0 0 0 1 0\n"), HasSubstr("t.txt:2: 'nan'"));
  EXPECT_THAT(kitti("2 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("t.txt:2: the 3x3 part"));
  EXPECT_THAT(kitti("-1 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("not a rotation"));
  const std::string tum = folder.write("t.tum", "0 0 0 0 0 0 0 0.5\n");
  EXPECT_THAT(error_of([&] { read_tum_trajectory(tum); }), HasSubstr("t.tum:1: the quaternion"));
}

TEST(TrajectoryErrors, ZeroForTheSameAndForAMovedCopy) {
  const Trajectory truth = curve(300);
  const Eigen::Isometry3d moved = pose(0.7, 20, -5);
  Trajectory estimate;
  for (const auto& p : truth) estimate.push_back(moved * p);
  const TrajectoryError error = trajectory_error(estimate, truth);
  EXPECT_NEAR(error.end_error, 0, 1e-9);
  EXPECT_NEAR(error.ate_rmse, 0, 1e-9);
  ASSERT_TRUE(error.segment.has_value());
  EXPECT_NEAR(error.segment->translation_percent, 0, 1e-9);
}

TEST(TrajectoryErrors, OnePercentTooLongIsOnePercent) {
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i <= 1000; ++i) {
    truth.push_back(pose(0, 0, i));
    estimate.push_back(pose(0, 0, 1.01 * i));
  }
  const TrajectoryError error = trajectory_error(estimate, truth);
  EXPECT_DOUBLE_EQ(error.distance, 1000);
  EXPECT_NEAR(error.end_error, 10, 1e-9);
  EXPECT_NEAR(error.end_error_percent, 1, 1e-9);
  ASSERT_TRUE(error.segment.has_value());
  // A segment ends at the first frame past its length: 101 frames for 100 m, 801 for 800 m.
  EXPECT_GT(error.segment->translation_percent, 1.0);
  EXPECT_LT(error.segment->translation_percent, 1.0101);
  EXPECT_NEAR(error.segment->rotation_degrees_per_100m, 0, 1e-9);
}

TEST(TrajectoryErrors, ShortPathHasNoSegments) {
  const TrajectoryError error = trajectory_error(curve(50), curve(50));
  EXPECT_FALSE(error.segment.has_value());
  EXPECT_THAT(error_of([] { trajectory_error(curve(3), curve(4)); }), HasSubstr("3 estimated"));
  EXPECT_THAT(error_of([] { trajectory_error({}, {}); }), HasSubstr("0 estimated"));
}

TEST(TrajectoryErrorsData, OrbSlamOnKitti00) {
  const std::string data = testing::data_folder();
  if (data.empty()) GTEST_SKIP() << "PARTITA_DATA is not set";
  const Trajectory truth = read_kitti_trajectory(data + "/traj_eval/KITTI_00_gt.txt");
  const Trajectory estimate = read_kitti_trajectory(data + "/traj_eval/KITTI_00_ORB.txt");
  const TrajectoryError error = trajectory_error(estimate, truth);
  RecordProperty("t_rel_percent", std::to_string(error.segment->translation_percent));
  RecordProperty("ate_rmse_m", std::to_string(error.ate_rmse));
  EXPECT_NEAR(error.distance, 3724.2, 0.5);
  EXPECT_NEAR(error.segment->translation_percent, 0.70, 0.03);  // as published
  EXPECT_NEAR(error.segment->rotation_degrees_per_100m, 0.25, 0.03);
  EXPECT_NEAR(error.ate_rmse, 1.3, 0.2);
}

}  // namespace
}  // namespace partita::io
