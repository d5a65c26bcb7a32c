// The readers of drives: columns by their names, clocks, what is left out and what is refused; and
// thousands of damaged files, each of which must end in a drive or in an Error of one line.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/io/csv.h"
#include "host/io/file.h"
#include "host/runtime/error.h"
#include "host/tasks/sensing/dataset.h"
#include "host/tasks/sensing/drive_csv.h"
#include "host/tasks/sensing/geodesy.h"
#include "host/tasks/sensing/oxts.h"
#include "host/tasks/sensing/rectify.h"
#include "tests/host/fuzz_text.h"
#include "tests/host/io_temp_folder.h"

namespace partita::sensing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::TempFolder;

constexpr const char* kImu = "timestamp_ns,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n";

SensorLog read(const TempFolder& folder, const std::string& text) {
  io::write_file(folder.file("drive.csv"), text);
  SensorLog log;
  std::optional<LocalMap> origin;
  read_drive_csv(folder.file("drive.csv"), log, origin);
  return log;
}

TEST(DriveCsv, ColumnsAreFoundByName) {
  const TempFolder folder;
  const SensorLog log = read(folder,
                             "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z "
                             "[rad s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
                             "1403715273262142976,1,2,3,4,5,6\n1403715273267142912,1,2,3,4,5,7\n");
  ASSERT_EQ(log.imu.size(), 2U);
  EXPECT_EQ(log.imu[0].timestamp_ns, 1403715273262142976);
  EXPECT_EQ(log.imu[1].accel, Eigen::Vector3d(4, 5, 7));
}

TEST(DriveCsv, WhatCannotBeUsedIsLeftOutAndTold) {
  const TempFolder folder;
  const SensorLog log = read(folder, std::string(kImu) +
                                         "0,0,0,0,0,0,9.8\n5000000,nan,0,0,0,0,9.8\n"
                                         "10000000,0,0,0,0,0,9.8\n10000000,0,0,0,0,0,9.8\n"
                                         "3000000,0,0,0,0,0,9.8\n15000000,0,0,0,0,0,1e9\n"
                                         "20000000,0,0,0,39.2,0,9.8\n25000000,0,0,0,39.2,0,9.8\n"
                                         "30000000,0,0,0,39.2,0,9.8\n35000000,0,0,0,0,0,9.8\n");
  EXPECT_EQ(log.imu.size(), 3U);
  EXPECT_THAT(log.notices, Contains(HasSubstr("drive.csv:3: not a number")));
  EXPECT_THAT(log.notices, Contains(HasSubstr("drive.csv:5: the time does not increase; 2 such")));
  EXPECT_THAT(log.notices, Contains(HasSubstr("drive.csv:7: beyond what any sensor")));
  EXPECT_THAT(log.notices, Contains(HasSubstr("drive.csv:8: at the end of the sensor's range; 3")));
}

TEST(DriveCsv, RowsAreOnTheReceiversClock) {
  const TempFolder folder;
  std::string text =
      "date,time,millis,ax,ay,az,rollrate,pitchrate,yawrate,speed [km/h],course,"
      "latitude,longitude\n";
  for (int row = 0; row < 100; ++row) {  // five rows a tick of 0.1 s; the logger lags and stutters
    const int tick = row / 5;
    text += "140214," + std::to_string(74852000 + 100 * tick) + "," +
            std::to_string(1392364134000LL + row * 20 + (row % 7) * 30 + row * 10) +
            ",0,0,9.8,0,0,1,36,90,51.0," + std::to_string(13.7 + 1.4245e-5 * tick) + "\n";
  }
  const SensorLog log = read(folder, text);
  ASSERT_EQ(log.imu.size(), 100U);
  for (std::size_t i = 1; i < 100; ++i) {
    EXPECT_NEAR(1e-9 * static_cast<double>(log.imu[i].timestamp_ns - log.imu[i - 1].timestamp_ns),
                0.02, 1e-3);
  }
  EXPECT_EQ(log.gps.size(), 20U);
  EXPECT_NEAR(*log.gps[3].speed, 10, 0.01);
  EXPECT_NEAR((log.gps[5].position - log.gps[4].position).x(), 1, 0.02);
  EXPECT_NEAR(log.imu[0].gyro.z(), 0.0174533, 1e-6);
  EXPECT_THAT(log.notices, Contains(HasSubstr("receiver's clock")));
}

TEST(DriveCsv, EmptyCellsAreNoFixes) {
  const TempFolder folder;
  const SensorLog log = read(folder,
                             "time_s,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z,east,"
                             "north\n0,0,0,0,0,0,9.8,1,2\n0.01,0,0,0,0,0,9.8,,\n"
                             "0.02,0,0,0,0,0,9.8,1,2.5\n");
  EXPECT_EQ(log.imu.size(), 3U);
  ASSERT_EQ(log.gps.size(), 2U);
  EXPECT_EQ(log.gps[1].position.y(), 2.5);
}

void expect_refused(const std::string& text, const std::string& message) {
  const TempFolder folder;
  try {
    read(folder, text);
    FAIL() << "expected: " << message;
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr(message));
  }
}

TEST(DriveCsv, ErrorsNameFileAndLine) {
  expect_refused(std::string(kImu) + "0,0,0,0,0,0,9.8\n5000000,x,0,0,0,0,9.8\n",
                 "drive.csv:3: 'x' in column 'gyro_x' is not a number");
  expect_refused(std::string(kImu) + "0,0,0,0,0,9.8\n", "drive.csv:2: 6 columns, expected 7");
  expect_refused("a,b\n1,2\n", "no column of time");
  expect_refused("time_s,b\n1,2\n", "neither inertial readings");
}

TEST(Geodesy, MetresOfADegree) {
  const LocalMap map({51.0, 13.7, 100});
  EXPECT_NEAR(map.to_map({51.001, 13.7, 100}).y(), 111.25, 0.05);
  EXPECT_NEAR(map.to_map({51.0, 13.701, 100}).x(), 70.2, 0.05);
  EXPECT_NEAR(map.to_map({51.0, 13.7, 101}).z(), 1, 1e-6);
}

TEST(KittiTimestamps, AreUtc) {
  const TempFolder folder;
  io::write_file(folder.file("t.txt"), "2011-09-26 14:05:35.500923136\n2011-09-26 14:05:36\n");
  const auto times = read_kitti_timestamps(folder.file("t.txt"));
  EXPECT_EQ(times[0] / 1'000'000'000, 1317045935);
  EXPECT_NEAR(static_cast<double>(times[0] % 1'000'000'000), 500923136, 100);
}

/// A point seen by both raw cameras lands in one row of the rectified pair, at its disparity.
TEST(Rectify, RowsAgreeAndDisparityIsDepth) {
  RawCamera left, right;
  left.fx = 458;
  left.fy = 457;
  left.cx = 367;
  left.cy = 248;
  left.distortion = {-0.28, 0.07, 2e-4, 2e-5, 0};
  left.width = 752;
  left.height = 480;
  right = left;
  right.cx = 380;
  Pose T_left_right = Pose::Identity();
  T_left_right.linear() =
      (Eigen::AngleAxisd(0.02, Eigen::Vector3d(0.3, 1, -0.2).normalized())).toRotationMatrix();
  T_left_right.translation() = Eigen::Vector3d(0.11, 0.002, -0.003);
  const Rectification r = rectify(left, right, T_left_right);
  const StereoCalibration& c = r.calibration;
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0.3, -0.2, 3), Eigen::Vector3d(-1, 0.5, 5)}) {
    const Eigen::Vector3d l = r.R_rect_left * p;
    const Eigen::Vector3d q = r.R_rect_right * (T_left_right.inverse() * p);
    EXPECT_NEAR(l.y() / l.z(), q.y() / q.z(), 1e-12);
    EXPECT_NEAR(c.fx * (l.x() / l.z() - q.x() / q.z()), c.fx * c.baseline / l.z(), 1e-9);
  }
}

const std::vector<std::string> kWords = {"nan", "-",        "1e999",
                                         ",",   "\n",       "",
                                         "#",   "inf",      "99999999999999999999",
                                         "[",   ";",        "1e-320",
                                         ":",   "\xff\xfe", std::string(1, '\0')};

/// How many of the mutations were refused.
template <class Read>
int fuzz(const std::string& valid, int rounds, Read read) {
  return testing::refused_mutations(valid, kWords, rounds, read);
}

TEST(DriveFuzz, Csv) {
  const TempFolder folder;
  const std::string combined =
      "date,time,millis,ax,ay,az,rollrate,pitchrate,yawrate,speed,course,latitude,longitude,epe\n"
      "140214,74852200,1392364131182.354,-0.6,-0.2,-10.6,0.6,-0.7,0.8,0,0,51.02972,13.7315,3.1\n"
      "140214,74852300,1392364131233.481,-0.9,0.4,-10.3,-0.5,-0.6,1.0,52.9,126,51.02972,13.7315,3\n"
      "140214,74852400,1392364131382.654,-0.1,0.2,-10.1,-0.5,-0.6,1.4,52.9,126,51.02971,13.7316,3\n"
      "140214,74852500,1392364131534.596,-0.1,0.2,-10.1,-0.5,-0.6,1.3,52.9,126,51.02970,13.7317,"
      "3\n";
  EXPECT_GT(fuzz(combined, 2000,
                 [&](const std::string& text) {
                   io::write_file(folder.file("drive.csv"), text);
                   open_dataset(folder.path());
                 }),
            400);
}

TEST(DriveFuzz, Timestamps) {
  const TempFolder folder;
  EXPECT_GT(fuzz("2011-09-26 14:05:35.500923136\n2011-09-26 14:05:35.602942464\n", 2000,
                 [&](const std::string& text) {
                   io::write_file(folder.file("t.txt"), text);
                   read_kitti_timestamps(folder.file("t.txt"));
                 }),
            400);
}

TEST(DriveFuzz, EurocYamlAndTruth) {
  const TempFolder folder;
  const std::string sensor =
      "%YAML:1.0\nsensor_type: imu\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, 0.0, 0.0, "
      "1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]\nrate_hz: 200\n"
      "gyroscope_noise_density: 1.6968e-04\ngyroscope_random_walk: 1.9393e-05\n";
  const std::string truth =
      "#timestamp,p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n"
      "1403715273262142976,0.8,2.1,0.9,1,0,0,0\n1403715273312143104,0.8,2.1,0.9,0.6,0.8,0,0\n";
  folder.write("mav0/imu0/data.csv", std::string(kImu) + "0,0,0,0,0,0,9.8\n5000000,0,0,0,0,0,9\n");
  folder.write("mav0/imu0/sensor.yaml", sensor);
  folder.write("mav0/state_groundtruth_estimate0/data.csv", truth);
  EXPECT_EQ(open_dataset(folder.path()).log.truth.size(), 2U);
  EXPECT_GT(fuzz(sensor, 1000,
                 [&](const std::string& text) {
                   io::write_file(folder.file("mav0/imu0/sensor.yaml"), text);
                   open_dataset(folder.path());
                 }),
            200);
  io::write_file(folder.file("mav0/imu0/sensor.yaml"), sensor);
  EXPECT_GT(fuzz(truth, 1000,
                 [&](const std::string& text) {
                   io::write_file(folder.file("mav0/state_groundtruth_estimate0/data.csv"), text);
                   open_dataset(folder.path());
                 }),
            200);
}

}  // namespace
}  // namespace partita::sensing
