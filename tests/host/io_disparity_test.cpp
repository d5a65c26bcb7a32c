// Disparities in the formats of the stereo benchmarks, and clouds of points.
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "host/io/file.h"
#include "host/io/image.h"
#include "host/io/pfm.h"
#include "host/io/point_cloud.h"
#include "host/io/truth.h"
#include "tests/host/io_temp_folder.h"

namespace partita::io {
namespace {

using sensing::FloatImage;
using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::error_of;
using ::testing::HasSubstr;
using testing::TempFolder;

std::string float_bytes(std::initializer_list<float> values, bool little) {
  std::string bytes;
  for (const float value : values) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int i = 0; i < 4; ++i) {
      bytes += static_cast<char>(bits >> (8 * (little ? i : 3 - i)) & 0xff);
    }
  }
  return bytes;
}

std::string encoded(const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", image, bytes);
  return {bytes.begin(), bytes.end()};
}

TEST(Pfm, BothByteOrdersBottomRowFirstWhateverTheScale) {
  const TempFolder folder;
  for (const bool little : {true, false}) {
    for (const char* scale : {"1", "0.003922", "1000", "1.0e+00"}) {
      const std::string header = std::string("Pf\n2 2\n") + (little ? "-" : "") + scale + "\n";
      const std::string bytes = header + float_bytes({3.5F, 4, 1, 2.25F}, little);
      EXPECT_THAT(read_pfm(folder.write("a.pfm", bytes)).pixels, ElementsAre(1, 2.25F, 3.5F, 4))
          << header;
    }
  }
}

TEST(Pfm, WhatIsNoDisparityIsNone) {
  const TempFolder folder;
  const float infinity = std::numeric_limits<float>::infinity();
  const std::string bytes = "Pf 4 1 -1\n" + float_bytes({infinity, std::nanf(""), -10, 7}, true);
  EXPECT_THAT(read_pfm(folder.write("a.pfm", bytes)).pixels, ElementsAre(0, 0, 0, 7));
}

TEST(Pfm, RoundTripKeepsEveryBit) {
  const TempFolder folder;
  FloatImage image(3, 2);
  image.pixels = {0.1F, 1.0F / 256, 254.999F, 0, 63, 1e-30F};
  write_disparity_as(folder.file("a.PFM"), image);
  EXPECT_EQ(read_pfm(folder.file("a.PFM")), image);
  // None is infinity, as Middlebury's tools expect it.
  const std::string bytes = read_file(folder.file("a.PFM"));
  EXPECT_THAT(bytes, HasSubstr(float_bytes({std::numeric_limits<float>::infinity()}, true)));
  EXPECT_THAT(error_of([&] { write_disparity_as(folder.file("a.jpg"), image); }),
              AllOf(HasSubstr("a.jpg"), HasSubstr(".pfm")));
}

TEST(Pfm, EveryTruncationAndSurplusIsAnError) {
  const TempFolder folder;
  const std::string whole = "Pf\n2 2\n-1\n" + float_bytes({1, 2, 3, 4}, true);
  EXPECT_EQ(read_pfm(folder.write("whole.pfm", whole)).at(0, 0), 3);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::string path = folder.write("cut.pfm", whole.substr(0, length));
    EXPECT_THAT(error_of([&] { read_pfm(path); }), HasSubstr(path)) << length;
  }
  const std::string longer = folder.write("longer.pfm", whole + "x");
  EXPECT_THAT(error_of([&] { read_pfm(longer); }), HasSubstr("17 bytes of samples, expected 16"));
}

TEST(Pfm, OddHeadersAreErrors) {
  const TempFolder folder;
  for (const char* header : {"PF\n1 1\n-1\n", "Pf\n0 1\n-1\n", "Pf\n-1 1\n-1\n", "Pf\n1 1\n0\n",
                             "Pf\n1 1\nnan\n", "Pf\n1 1\n-inf\n", "Pf\n1e0 1\n-1\n",
                             "Pf\n99999 99999\n-1\n", "P5\n1 1\n-1\n", "Pf\n1 1 x\n"}) {
    const std::string path = folder.write("a.pfm", header + float_bytes({1}, true));
    EXPECT_THAT(error_of([&] { read_pfm(path); }), HasSubstr(path)) << header;
  }
}

TEST(Truth, KittiHasSixteenBits) {
  const TempFolder folder;
  cv::Mat image(1, 3, CV_16U);
  image.at<std::uint16_t>(0, 0) = 0;
  image.at<std::uint16_t>(0, 1) = 256;
  image.at<std::uint16_t>(0, 2) = 1000;
  const std::string path = folder.write("a.png", encoded(image));
  EXPECT_THAT(read_truth(path).disparity.pixels, ElementsAre(0, 1, 1000.0F / 256));
  EXPECT_THAT(read_truth(path, 100).disparity.pixels, ElementsAre(0, 2.56F, 10));
}

TEST(Truth, MiddleburyHasEightBitsAndAScaleBesideThem) {
  const TempFolder folder;
  cv::Mat image(1, 3, CV_8U, cv::Scalar(18));
  image.at<std::uint8_t>(0, 0) = 0;
  const std::string path = folder.write("groundtruth.png", encoded(image));
  EXPECT_THAT(error_of([&] { read_truth(path); }), AllOf(HasSubstr(path), HasSubstr("info.txt")));
  EXPECT_THAT(read_truth(path, 8).disparity.pixels, ElementsAre(0, 2.25F, 2.25F));
  folder.write("info.txt", "4\n59");
  const Truth truth = read_truth(path);
  EXPECT_THAT(truth.disparity.pixels, ElementsAre(0, 4.5F, 4.5F));
  EXPECT_EQ(truth.format, "8 bit, 4 levels a pixel");
  for (const char* text : {"", "-4\n", "0\n", "four\n"}) {
    const std::string info = folder.write("info.txt", text);
    EXPECT_THAT(error_of([&] { read_truth(path); }), HasSubstr(info)) << text;
  }
}

/// As palettes decode: three channels. Where they differ it is a picture of something else.
TEST(Truth, APaletteOfGraysIsOneChannel) {
  const TempFolder folder;
  cv::Mat image(1, 2, CV_8UC3, cv::Scalar::all(48));
  EXPECT_THAT(read_truth(folder.write("a.png", encoded(image)), 16).disparity.pixels,
              ElementsAre(3, 3));
  image.at<cv::Vec3b>(0, 1)[2] = 49;
  const std::string path = folder.write("b.png", encoded(image));
  EXPECT_THAT(error_of([&] { read_truth(path, 16); }), AllOf(HasSubstr(path), HasSubstr("colour")));
}

TEST(Truth, NothingKnownIsAnError) {
  const TempFolder folder;
  const std::string path = folder.write("a.png", encoded(cv::Mat(2, 2, CV_16U, cv::Scalar(0))));
  EXPECT_THAT(error_of([&] { read_truth(path); }), AllOf(HasSubstr(path), HasSubstr("known")));
  const std::string pfm = folder.write("a.pfm", "Pf 1 1 -1\n" + float_bytes({3}, true));
  EXPECT_THAT(error_of([&] { read_truth(pfm, 4); }), AllOf(HasSubstr(pfm), HasSubstr("scale")));
}

TEST(Masks, OnlyWhiteCounts) {
  const TempFolder folder;
  cv::Mat image(1, 3, CV_8U, cv::Scalar(255));
  image.at<std::uint8_t>(0, 0) = 0;
  image.at<std::uint8_t>(0, 1) = 128;
  EXPECT_THAT(read_mask(folder.write("m.png", encoded(image))).pixels, ElementsAre(0, 0, 255));
}

TEST(Ply, HeaderAndPointsAreWhatViewersExpect) {
  const TempFolder folder;
  const std::vector<CloudPoint> points{{1, -2, 3.5F, 200}, {0.25F, 0, 9, 7}};
  write_ply(folder.file("a.ply"), points, "a comment");
  const std::string expected =
      "ply\nformat binary_little_endian 1.0\ncomment a comment\nelement vertex 2\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n" +
      float_bytes({1, -2, 3.5F}, true) + std::string(3, '\xc8') + float_bytes({0.25F, 0, 9}, true) +
      std::string(3, '\x07');
  EXPECT_EQ(read_file(folder.file("a.ply")), expected);
}

/// The benchmarks' own files, where they are at hand.
TEST(Truth, RealFiles) {
  const std::string data = testing::data_folder();
  if (data.empty()) GTEST_SKIP() << "PARTITA_DATA is not set: no real truth to read";
  const FloatImage motorcycle =
      read_truth(data + "/stereo_middlebury2014_motorcycleQ/disp0GT.pfm").disparity;
  EXPECT_EQ(motorcycle.width, 741);
  const float most = *std::max_element(motorcycle.pixels.begin(), motorcycle.pixels.end());
  EXPECT_GT(most, 60);
  EXPECT_LT(most, 65);  // its calib.txt says vmax=65
  const Truth tsukuba = read_truth(data + "/stereo_middlebury_v2/tsukuba/groundtruth.png");
  EXPECT_EQ(*std::max_element(tsukuba.disparity.pixels.begin(), tsukuba.disparity.pixels.end()),
            14);
  const Truth kitti = read_truth(data + "/stereo_kitti2015_000046/disp_occ_0/000046_10.png");
  EXPECT_EQ(kitti.format, "16 bit, 256 levels a pixel");
}

}  // namespace
}  // namespace partita::io
