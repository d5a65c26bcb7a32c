#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "host/io/file.h"
#include "host/io/image.h"
#include "host/tasks/sensing/frame.h"
#include "host/tasks/sensing/kitti_calibration.h"
#include "host/tasks/sensing/kitti_write.h"
#include "host/tasks/sensing/synchronise.h"
#include "tests/host/io_temp_folder.h"

namespace partita::sensing {
namespace {

using ::testing::AllOf;
using testing::error_of;
using ::testing::HasSubstr;
using testing::TempFolder;
namespace fs = std::filesystem;

/// A small, valid sequence to break in one place.
class Kitti : public ::testing::Test {
 protected:
  static constexpr int kFrames = 4;

  Kitti() {
    folder_.write("calib.txt",
                  "P0: 70 0 15.5 0 0 70 11.5 0 0 0 1 0\nP1: 70 0 15.5 -35 0 70 11.5 0 0 0 1 0\n"
                  "Tr: not numbers at all\n");
    std::string times;
    std::string poses;
    for (int i = 0; i < kFrames; ++i) {
      for (const char* side : {"image_0", "image_1"}) {
        fs::create_directories(folder_.file(side));
        GrayImage image(32, 24, static_cast<std::uint8_t>(10 * i + (side[6] - '0')));
        image.at(3, 4) = 200;
        io::write_gray(folder_.file(std::string(side) + "/00000" + std::to_string(i) + ".png"),
                       image);
      }
      times += std::to_string(0.25 * i) + "\n";
      poses += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(i) + "\n";
    }
    folder_.write("times.txt", times);
    folder_.write("poses.txt", poses);
  }

  std::string open_error() {
    return error_of([this] { open_kitti(folder_.path()); });
  }
  std::string frame_error(std::size_t index) {
    const auto source = open_kitti(folder_.path());
    return error_of([&] { source->frame(index); });
  }

  TempFolder folder_;
};

TEST_F(Kitti, ReadsEverything) {
  const auto source = open_kitti(folder_.path());
  EXPECT_EQ(source->size(), 4U);
  EXPECT_EQ(source->calibration().width, 32);
  EXPECT_EQ(source->calibration().height, 24);
  EXPECT_DOUBLE_EQ(source->calibration().fx, 70);
  EXPECT_DOUBLE_EQ(source->calibration().baseline, 0.5);
  const Frame f = source->frame(2);
  EXPECT_EQ(f.timestamp_ns, 500'000'000);
  EXPECT_EQ(f.left.at(0, 0), 20);
  EXPECT_EQ(f.right.at(0, 0), 21);
  EXPECT_DOUBLE_EQ(f.T_world_cam->translation().z(), 2);
  EXPECT_EQ(source->true_poses()->size(), 4U);
  EXPECT_TRUE(source->notices().empty());
}

TEST_F(Kitti, TenHertzWithoutTimesAndNoTruthWithoutPoses) {
  fs::remove(folder_.file("times.txt"));
  fs::remove(folder_.file("poses.txt"));
  const auto source = open_kitti(folder_.path());
  EXPECT_EQ(source->timestamp_ns(3), 300'000'000);
  EXPECT_FALSE(source->true_poses().has_value());
  ASSERT_EQ(source->notices().size(), 1U);
  EXPECT_THAT(source->notices()[0], HasSubstr("10 Hz"));
}

TEST_F(Kitti, PosesOfTheStandardLayout) {
  const TempFolder root;
  fs::create_directories(root.file("poses"));
  fs::create_directories(root.file("sequences"));
  fs::copy(folder_.path(), root.file("sequences/07"), fs::copy_options::recursive);
  fs::rename(root.file("sequences/07/poses.txt"), root.file("poses/07.txt"));
  EXPECT_TRUE(open_kitti(root.file("sequences/07"))->true_poses().has_value());
  EXPECT_TRUE(open_kitti(root.file("sequences/07/"))->true_poses().has_value());
}

TEST_F(Kitti, MissingFolderOrImages) {
  EXPECT_THAT(error_of([] { open_kitti("/nonexistent/seq"); }), HasSubstr("/nonexistent/seq"));
  fs::remove_all(folder_.file("image_1"));
  EXPECT_THAT(open_error(), AllOf(HasSubstr("image_1"), HasSubstr("right")));
  fs::remove_all(folder_.file("image_0"));
  EXPECT_THAT(open_error(), HasSubstr("no images"));
}

TEST_F(Kitti, FrameCountMismatchNamesTheMissingImage) {
  fs::remove(folder_.file("image_1/000003.png"));
  EXPECT_THAT(open_error(),
              AllOf(HasSubstr("4 left and 3 right"), HasSubstr("image_1/000003.png")));
}

TEST_F(Kitti, AHoleInTheNumberingNamesTheMissingImage) {
  for (const std::string side : {"image_0/", "image_1/"}) {
    fs::remove(folder_.file(side + "000002.png"));
  }
  EXPECT_THAT(open_error(), HasSubstr("image_0/000002.png is missing"));
}

TEST_F(Kitti, NumbersMayStartAnywhereAndNamesNeedNotBeNumbers) {
  for (const std::string side : {"image_0/", "image_1/"}) {
    fs::remove(folder_.file(side + "000000.png"));
  }
  EXPECT_EQ(open_kitti(folder_.path())->size(), 3U);
  for (const std::string side : {"image_0/", "image_1/"}) {
    fs::rename(folder_.file(side + "000002.png"), folder_.file(side + "2b.png"));
  }
  EXPECT_EQ(open_kitti(folder_.path())->size(), 3U);
  for (const std::string side : {"image_0/", "image_1/"}) {
    fs::rename(folder_.file(side + "000001.png"), folder_.file(side + "1403715273262142976.png"));
    fs::rename(folder_.file(side + "2b.png"), folder_.file(side + "1403715273312143104.png"));
    fs::rename(folder_.file(side + "000003.png"), folder_.file(side + "1403715273362142976.png"));
  }
  EXPECT_EQ(open_kitti(folder_.path())->size(), 3U);
}

TEST_F(Kitti, NumbersWithoutLeadingZerosAreInTheNumbersOrder) {
  const GrayImage second = open_kitti(folder_.path())->frame(1).left;
  for (const std::string side : {"image_0/", "image_1/"}) {
    for (int i = 0; i < 4; ++i) {
      fs::rename(folder_.file(side + "00000" + std::to_string(i) + ".png"),
                 folder_.file(side + std::to_string(8 + i) + ".png"));
    }
  }
  const auto source = open_kitti(folder_.path());
  ASSERT_EQ(source->size(), 4U);
  EXPECT_EQ(source->frame(1).left, second);
}

TEST_F(Kitti, ExtensionsInCapitals) {
  for (const std::string side : {"image_0/", "image_1/"}) {
    fs::rename(folder_.file(side + "000001.png"), folder_.file(side + "000001.PNG"));
  }
  const auto source = open_kitti(folder_.path());
  ASSERT_EQ(source->size(), 4U);
  EXPECT_EQ(source->frame(1).left.at(0, 0), 10);
}

TEST_F(Kitti, TruncatedImageNamesTheFile) {
  const std::string path = folder_.file("image_1/000002.png");
  const std::string bytes = io::read_file(path);
  io::write_file(path, std::string_view(bytes).substr(0, bytes.size() - 20));
  EXPECT_THAT(frame_error(2), AllOf(HasSubstr(path), HasSubstr("truncated")));
}

TEST_F(Kitti, DifferingSizesNameTheFileAndBothSizes) {
  io::write_gray(folder_.file("image_1/000001.png"), GrayImage(30, 24));
  EXPECT_THAT(frame_error(1),
              AllOf(HasSubstr("image_1/000001.png"), HasSubstr("30x24"), HasSubstr("32x24")));
  io::write_gray(folder_.file("image_0/000002.png"), GrayImage(32, 20));
  EXPECT_THAT(frame_error(2), HasSubstr("image_0/000002.png"));
}

TEST_F(Kitti, CalibrationForAnotherPictureSize) {
  folder_.write("calib.txt", "70 0 99 0 0 70 11 0 0 0 1 0\n70 0 99 -35 0 70 11 0 0 0 1 0\n");
  EXPECT_THAT(open_error(), AllOf(HasSubstr("32x24"), HasSubstr("calib.txt")));
}

TEST_F(Kitti, ColourIsConvertedWithANotice) {
  cv::imwrite(folder_.file("image_0/000001.png"), cv::Mat(24, 32, CV_8UC3, cv::Scalar(9, 9, 9)));
  const auto source = open_kitti(folder_.path());
  EXPECT_EQ(source->frame(1).left.at(0, 0), 9);
  ASSERT_EQ(source->notices().size(), 1U);
  EXPECT_THAT(source->notices()[0], HasSubstr("colour"));
}

TEST_F(Kitti, CalibrationErrorsNameFileAndLine) {
  const auto calib = [this](const std::string& text) {
    folder_.write("calib.txt", text);
    return open_error();
  };
  const std::string p0 = "P0: 70 0 15.5 0 0 70 11.5 0 0 0 1 0\n";
  EXPECT_THAT(calib(p0), HasSubstr("no line 'P1:'"));
  EXPECT_THAT(calib(""), HasSubstr("calib.txt"));
  EXPECT_THAT(calib(p0 + "P1: 70 0 15.5 -35 0 70 11.5\n"), HasSubstr("calib.txt:2: 7 numbers"));
  EXPECT_THAT(calib(p0 + "P1: 70 0 x -35 0 70 11.5 0 0 0 1 0\n"), HasSubstr("calib.txt:2: 'x'"));
  EXPECT_THAT(calib(p0 + "P1: 80 0 15.5 -35 0 70 11.5 0 0 0 1 0\n"), HasSubstr("differ"));
  EXPECT_THAT(calib(p0 + "P1: 70 0 15.5 35 0 70 11.5 0 0 0 1 0\n"), HasSubstr("baseline"));
  EXPECT_THAT(calib("P0: -7 0 15.5 0 0 70 11.5 0 0 0 1 0\nP1: 0 0 0 0 0 0 0 0 0 0 0 0\n"),
              HasSubstr("calib.txt:1: not a pinhole"));
  fs::remove(folder_.file("calib.txt"));
  EXPECT_THAT(open_error(), HasSubstr("calib.txt"));
}

TEST_F(Kitti, TimesAndPosesErrors) {
  folder_.write("times.txt", "0\n0.1\n0.1\n0.2\n");
  EXPECT_THAT(open_error(), HasSubstr("times.txt:3: the time does not increase"));
  folder_.write("times.txt", "0\n0.1\n");
  EXPECT_THAT(open_error(), AllOf(HasSubstr("times.txt: 2 times"), HasSubstr("4 frames")));
  fs::remove(folder_.file("times.txt"));
  folder_.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 nan\n");
  EXPECT_THAT(open_error(), HasSubstr("poses.txt:2: 'nan'"));
  folder_.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(open_error(), HasSubstr("1 poses, expected one for each of the 4 frames"));
}

TEST_F(Kitti, OutOfSyncCamerasAreRefused) {
  folder_.write("times_right.txt", "0\n0.2505\n0.5\n0.75\n");
  EXPECT_EQ(open_kitti(folder_.path())->size(), 4U);
  folder_.write("times_right.txt", "0\n0.25\n0.502\n0.75\n");
  EXPECT_THAT(open_error(), AllOf(HasSubstr("000002.png"), HasSubstr("500000000"),
                                  HasSubstr("502000000"), HasSubstr("out of sync")));
}

TEST(Synchronise, ToleranceIsInclusiveAndSymmetric) {
  EXPECT_NO_THROW(check_synchronised("f", 5, 15, 10));
  EXPECT_NO_THROW(check_synchronised("f", 15, 5, 10));
  EXPECT_THAT(error_of([] { check_synchronised("f", 5, 16, 10); }), HasSubstr("f: left at 5 ns"));
  EXPECT_THAT(error_of([] { check_synchronised("f", 16, 5, 10); }), HasSubstr("right at 5 ns"));
}

TEST(KittiWrite, RoundTrip) {
  const TempFolder folder;
  ScenarioOptions options;
  options.frames = 3;
  options.width = 192;
  options.height = 108;
  const auto scenario = open_scenario(options);
  std::size_t calls = 0;
  write_kitti(*scenario, folder.file("out"), [&](std::size_t, std::size_t) { ++calls; });
  EXPECT_EQ(calls, 3U);
  EXPECT_TRUE(fs::exists(folder.file("out/label_2/000002.txt")));
  const auto read = open_kitti(folder.file("out"));
  ASSERT_EQ(read->size(), 3U);
  EXPECT_NEAR(read->calibration().baseline, scenario->calibration().baseline, 1e-15);
  EXPECT_EQ(read->calibration().fx, scenario->calibration().fx);
  EXPECT_EQ(read->calibration().cy, scenario->calibration().cy);
  for (std::size_t i = 0; i < 3; ++i) {
    const Frame a = scenario->frame(i);
    const Frame b = read->frame(i);
    EXPECT_EQ(a.timestamp_ns, b.timestamp_ns);
    EXPECT_EQ(a.left, b.left);
    EXPECT_EQ(a.right, b.right);
    EXPECT_TRUE(a.T_world_cam->matrix().isApprox(b.T_world_cam->matrix(), 1e-9));
    ASSERT_EQ(a.imu.size(), b.imu.size());
    ASSERT_EQ(a.gps.size(), b.gps.size());
    EXPECT_EQ(a.imu.back().accel, b.imu.back().accel);
    for (std::size_t k = 0; k < a.disparity->pixels.size(); ++k) {
      const float truth = std::min(a.disparity->pixels[k], 65535.0F / 256);
      ASSERT_NEAR(truth, b.disparity->pixels[k], 0.5 / 256 + 1e-6);
    }
  }
}

TEST(KittiWrite, InterruptedIsNeverTakenAsWhole) {
  const TempFolder folder;
  ScenarioOptions options;
  options.frames = 3;
  options.width = 96;
  options.height = 64;
  const auto stop = [](std::size_t done, std::size_t) {
    if (done == 2) throw Error("interrupted");
  };
  error_of([&] { write_kitti(*open_scenario(options), folder.file("out"), stop); });
  EXPECT_THAT(error_of([&] { open_kitti(folder.file("out")); }), HasSubstr("PARTIAL"));
}

TEST(KittiData, OdometrySequence) {
  const std::string data = testing::data_folder();
  if (data.empty()) GTEST_SKIP() << "PARTITA_DATA is not set";
  const auto source = open_kitti(data + "/seq_kitti_odom_1");
  EXPECT_EQ(source->size(), 51U);
  EXPECT_EQ(source->calibration().width, 1226);
  EXPECT_EQ(source->calibration().height, 370);
  EXPECT_NEAR(source->calibration().fx, 707.0912, 1e-9);
  EXPECT_NEAR(source->calibration().baseline, 0.53715, 1e-4);
  EXPECT_EQ(source->true_poses()->size(), 51U);
  const Frame last = source->frame(50);
  EXPECT_EQ(last.timestamp_ns, 5'000'000'000);
  EXPECT_EQ(last.left.width, last.right.width);
}

}  // namespace
}  // namespace partita::sensing
