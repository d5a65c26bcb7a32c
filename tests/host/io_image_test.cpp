#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "host/io/file.h"
#include "host/io/image.h"
#include "host/io/image_check.h"
#include "tests/host/io_temp_folder.h"

namespace partita::io {
namespace {

using sensing::FloatImage;
using sensing::GrayImage;
using ::testing::AllOf;
using testing::error_of;
using ::testing::HasSubstr;
using testing::TempFolder;

GrayImage pattern(int width, int height) {
  GrayImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.at(x, y) = static_cast<std::uint8_t>(x * 7 + y * y * 3);
  }
  return image;
}

std::string encoded(const std::string& extension, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, image, bytes);
  return {bytes.begin(), bytes.end()};
}

cv::Mat colour_picture() {
  cv::Mat image(40, 60, CV_8UC3);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) image.at<cv::Vec3b>(y, x) = cv::Vec3b(4 * x, 6 * y, x + y);
  }
  return image;
}

TEST(GrayImages, RoundTrip) {
  const TempFolder folder;
  const GrayImage image = pattern(61, 37);
  write_gray(folder.file("a.png"), image);
  const GrayRead read = read_gray(folder.file("a.png"));
  EXPECT_EQ(read.image, image);
  EXPECT_EQ(read.converted, "");
}

TEST(GrayImages, ColourAndSixteenBitsAreConvertedAndSaidSo) {
  const TempFolder folder;
  const GrayRead colour = read_gray(folder.write("c.png", encoded(".png", colour_picture())));
  EXPECT_EQ(colour.converted, "colour");
  const double expected = 0.299 * (20 + 10) + 0.587 * 60 + 0.114 * 80;
  EXPECT_NEAR(colour.image.at(20, 10), expected, 1.0);
  const cv::Mat deep(5, 6, CV_16U, cv::Scalar(0x7fff));
  const GrayRead sixteen = read_gray(folder.write("d.png", encoded(".png", deep)));
  EXPECT_EQ(sixteen.converted, "16-bit");
  EXPECT_EQ(sixteen.image.at(3, 3), 0x7f);
}

/// Every proper prefix of a picture is refused, except for those that lack only trailing bytes
/// which belong to no sample.
TEST(GrayImages, EveryTruncationIsAnError) {
  const TempFolder folder;
  for (const char* extension : {".png", ".jpg", ".pgm", ".ppm"}) {
    cv::Mat image = colour_picture();
    if (std::string(extension) == ".pgm") image = cv::Mat(40, 60, CV_8U, cv::Scalar(77));
    const std::string whole = encoded(extension, image);
    EXPECT_EQ(image_defect(whole), "") << extension;
    EXPECT_EQ(read_gray(folder.write("whole" + std::string(extension), whole)).image.width, 60);
    for (std::size_t length = 0; length < whole.size(); ++length) {
      EXPECT_NE(image_defect(whole.substr(0, length)), "") << extension << " of " << length;
    }
    const std::string path = folder.write("cut" + std::string(extension), whole.substr(0, 400));
    EXPECT_THAT(error_of([&] { read_gray(path); }), AllOf(HasSubstr(path), HasSubstr("truncated")));
  }
}

TEST(GrayImages, DamageIsAnErrorThatNamesTheFile) {
  const TempFolder folder;
  std::string bytes = encoded(".png", colour_picture());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  const std::string damaged = folder.write("damaged.png", bytes);
  EXPECT_THAT(error_of([&] { read_gray(damaged); }),
              AllOf(HasSubstr(damaged), HasSubstr("checksum")));
  const std::string text = folder.write("text.png", "this is no picture");
  EXPECT_THAT(error_of([&] { read_gray(text); }), HasSubstr("not a PNG, JPEG or PGM"));
  EXPECT_THAT(error_of([&] { read_gray(folder.file("none.png")); }), HasSubstr("none.png"));
  const std::string empty = folder.write("empty.png", "");
  EXPECT_THAT(error_of([&] { read_gray(empty); }), HasSubstr("empty"));
}

TEST(Disparity, RoundTripToTheNearestStep) {
  const TempFolder folder;
  FloatImage map(4, 2);
  map.pixels = {0.0F, 1.0F,  63.25F, 12.3456F, -3.0F, std::numeric_limits<float>::quiet_NaN(),
                1e9F, 0.001F};
  write_disparity(folder.file("d.png"), map);
  const FloatImage read = read_disparity(folder.file("d.png"));
  const std::vector<float> expected = {0.0F, 1.0F, 63.25F,         3160.0F / 256,
                                       0.0F, 0.0F, 65535.0F / 256, 0.0F};
  EXPECT_EQ(read.pixels, expected);
  write_gray(folder.file("g.png"), pattern(4, 4));
  EXPECT_THAT(error_of([&] { read_disparity(folder.file("g.png")); }), HasSubstr("16-bit"));
}

TEST(Disparity, PictureHasTheColourBarBelow) {
  const TempFolder folder;
  FloatImage map(300, 100, 0.0F);
  for (int x = 0; x < 150; ++x) map.at(x, 50) = 40.0F;
  write_disparity_picture(folder.file("p.png"), map, 80.0);
  const cv::Mat picture = cv::imread(folder.file("p.png"));
  ASSERT_EQ(picture.size(), cv::Size(300, 144));
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 0, 0));
  EXPECT_NE(picture.at<cv::Vec3b>(50, 10), cv::Vec3b(0, 0, 0));
  EXPECT_GT(picture.at<cv::Vec3b>(112, 16)[0], 100);   // the bar begins blue
  EXPECT_GT(picture.at<cv::Vec3b>(112, 284)[2], 100);  // and ends red
}

}  // namespace
}  // namespace partita::io
