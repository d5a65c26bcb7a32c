#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/tasks/sensing/stereo_calibration.h"
#include "tests/host/io_temp_folder.h"

namespace partita::sensing {
namespace {

using ::testing::AllOf;
using testing::error_of;
using ::testing::HasSubstr;
using testing::TempFolder;

const std::string kMiddlebury =
    "cam0=[999.421 0 294.182; 0 999.421 252.932; 0 0 1]\n"
    "cam1=[999.421 0 326.96; 0 999.421 252.932; 0 0 1]\n"
    "doffs=32.778\nbaseline=193.001\nwidth=741\nheight=497\nndisp=70\nisint=0\n";

TEST(StereoCalibrations, MiddleburyIsInMillimetresAndShifted) {
  const TempFolder folder;
  const PairCalibration c = read_stereo_calibration(folder.write("calib.txt", kMiddlebury), 0);
  EXPECT_DOUBLE_EQ(c.camera.fx, 999.421);
  EXPECT_DOUBLE_EQ(c.camera.cx, 294.182);
  EXPECT_DOUBLE_EQ(c.camera.cy, 252.932);
  EXPECT_DOUBLE_EQ(c.camera.baseline, 0.193001);
  EXPECT_DOUBLE_EQ(c.disparity_offset, 32.778);
  EXPECT_EQ(c.camera.width, 741);
  EXPECT_EQ(c.camera.height, 497);
}

TEST(StereoCalibrations, WithoutDoffsItFollowsFromTheCameras) {
  const TempFolder folder;
  std::string text = kMiddlebury;
  text.erase(text.find("doffs"), sizeof("doffs=32.778"));
  EXPECT_NEAR(read_stereo_calibration(folder.write("calib.txt", text), 0).disparity_offset, 32.778,
              1e-9);
}

TEST(StereoCalibrations, KittiByEitherName) {
  const TempFolder folder;
  const std::string left = " 700 0 600 44.8 0 700 180 0 0 0 1 0\n";
  const std::string right = " 700 0 600 -331.2 0 700 180 0 0 0 1 0\n";
  for (const auto& [one, other] : {std::pair{"P2:", "P3:"}, {"P_rect_02:", "P_rect_03:"}}) {
    const std::string text = "calib_time: 09-Jan-2012 13:57:47\n" + (one + left) + other + right;
    const PairCalibration c = read_stereo_calibration(folder.write("calib.txt", text), 2);
    EXPECT_NEAR(c.camera.baseline, 376.0 / 700, 1e-12) << one;
    EXPECT_EQ(c.disparity_offset, 0);
    EXPECT_EQ(c.camera.width, 0);
  }
}

TEST(StereoCalibrations, WhatIsWrongIsSaidWithTheLine) {
  const TempFolder folder;
  const auto error_with = [&](const std::string& what, const std::string& with) {
    std::string text = kMiddlebury;
    text.replace(text.find(what), what.size(), with);
    const std::string path = folder.write("calib.txt", text);
    return error_of([&] { read_stereo_calibration(path, 0); });
  };
  EXPECT_THAT(error_with("cam1=[999.421", "cam1=[998"), AllOf(HasSubstr(":2:"), HasSubstr("fx")));
  EXPECT_THAT(error_with("cam0=[999.421 0", "cam0=[999.421 1"), HasSubstr(":1: not a pinhole"));
  EXPECT_THAT(error_with("baseline=193.001", "baseline=-1"), HasSubstr(":4:"));
  EXPECT_THAT(error_with("baseline=", "basis="), HasSubstr("'baseline='"));
  EXPECT_THAT(error_with("width=741", "width=741.5"), AllOf(HasSubstr(":5:"), HasSubstr("whole")));
  EXPECT_THAT(error_with("doffs=32.778", "doffs=much"), AllOf(HasSubstr(":3:"), HasSubstr("much")));
  EXPECT_THAT(error_with("height=497", "height 497"), AllOf(HasSubstr(":6:"), HasSubstr("key")));
}

}  // namespace
}  // namespace partita::sensing
