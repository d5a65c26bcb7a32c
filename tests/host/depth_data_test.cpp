// Accuracy on real pairs with ground truth, beside libelas's figures (setting "robotics") on the
// same pairs.
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "host/tasks/depth/depth.h"
#include "host/tasks/depth/kernels.h"
#include "tests/kernels/kernel_tests.h"

namespace partita::depth {
namespace {

struct Scene {
  std::string name;
  std::string left;
  std::string right;
  std::string truth;
  double truth_scale;  ///< grey levels per pixel of disparity; 0: a PFM file
  double libelas_density;
  double libelas_bad1;
  double libelas_bad3;
};

const std::array<Scene, 5> kScenes{{
    {"cones", "stereo_middlebury_v2/cones/imL.png", "stereo_middlebury_v2/cones/imR.png",
     "stereo_middlebury_v2/cones/groundtruth.png", 4, 81, 6.26, 3.10},
    {"teddy", "stereo_middlebury_v2/teddy/imL.png", "stereo_middlebury_v2/teddy/imR.png",
     "stereo_middlebury_v2/teddy/groundtruth.png", 4, 80, 10.23, 4.85},
    {"venus", "stereo_middlebury_v2/venus/imL.png", "stereo_middlebury_v2/venus/imR.png",
     "stereo_middlebury_v2/venus/groundtruth.png", 8, 90, 4.28, 1.68},
    {"KITTI 2015 #46", "stereo_kitti2015_000046/image_2/000046_10.png",
     "stereo_kitti2015_000046/image_3/000046_10.png",
     "stereo_kitti2015_000046/disp_occ_0/000046_10.png", 256, 81, 19.86, 1.41},
    {"motorcycleQ", "stereo_middlebury2014_motorcycleQ/im0.png",
     "stereo_middlebury2014_motorcycleQ/im1.png", "stereo_middlebury2014_motorcycleQ/disp0GT.pfm",
     0, 86, 13.0, 6.57},
}};

sensing::GrayImage read_gray(const std::string& path) {
  const cv::Mat image = cv::imread(path, cv::IMREAD_GRAYSCALE);
  sensing::GrayImage out(image.cols, image.rows);
  for (int y = 0; y < image.rows; ++y) std::copy_n(image.ptr(y), image.cols, out.row(y));
  return out;
}

/// Disparities in pixels, 0 where there is none.
sensing::FloatImage read_truth(const std::string& path, double scale) {
  if (scale == 0) {  // little-endian floats, bottom row first; the header's scale is not one
    std::ifstream file(path, std::ios::binary);
    std::string kind;
    int width = 0;
    int height = 0;
    double ignored = 0;
    file >> kind >> width >> height >> ignored;
    file.get();
    sensing::FloatImage out(width, height);
    for (int y = height - 1; y >= 0; --y) {
      file.read(reinterpret_cast<char*>(out.row(y)), std::streamsize{4} * width);
    }
    for (float& d : out.pixels) d = std::isfinite(d) ? d : 0;
    return out;
  }
  cv::Mat image = cv::imread(path, cv::IMREAD_UNCHANGED);
  if (image.channels() > 1) cv::extractChannel(image, image, 0);
  sensing::FloatImage out(image.cols, image.rows);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const int value =
          image.depth() == CV_16U ? image.at<std::uint16_t>(y, x) : image.at<std::uint8_t>(y, x);
      out.at(x, y) = static_cast<float>(value / scale);
    }
  }
  return out;
}

struct Accuracy {
  double density = 0;  ///< all in percent of the pixels with truth (density) or with both
  double bad1 = 0;
  double bad3 = 0;
};

Accuracy compare(const DisparityMap& map, const sensing::FloatImage& truth) {
  int known = 0;
  int both = 0;
  int over1 = 0;
  int over3 = 0;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      if (truth.at(x, y) <= 0) continue;
      ++known;
      if (!map.valid(x, y)) continue;
      ++both;
      const float error = std::abs(map.pixels(x, y) - truth.at(x, y));
      over1 += error > 1;
      over3 += error > 3;
    }
  }
  return {100.0 * both / known, 100.0 * over1 / both, 100.0 * over3 / both};
}

Accuracy measure(const std::string& folder, const Scene& scene, const DepthParameters& parameters) {
  static const runtime::Session session = [] {
    runtime::SessionOptions options;
    options.variant = runtime::Variant::cpu;
    options.cache_folder = "-";
    return runtime::Session(tests::source_device(), kernel_specs(), options);
  }();
  const sensing::GrayImage left = read_gray(folder + scene.left);
  const sensing::GrayImage right = read_gray(folder + scene.right);
  Depth depth(session, left.width, left.height, parameters);
  return compare(depth.process(left, right, 0),
                 read_truth(folder + scene.truth, scene.truth_scale));
}

TEST(DepthData, AsAccurateAndDenseAsLibelas) {
  const char* data = std::getenv("PARTITA_DATA");
  if (data == nullptr) GTEST_SKIP() << "PARTITA_DATA is not set: no real pictures to match";
  double more_bad1 = 0;
  double more_bad3 = 0;
  fmt::print("{:<16}{:>9}{:>8}{:>8}   libelas: density, bad-1, bad-3\n", "scene", "density",
             "bad-1", "bad-3");
  for (const Scene& scene : kScenes) {
    const Accuracy got = measure(std::string(data) + "/", scene, {});
    fmt::print("{:<16}{:>9.1f}{:>8.2f}{:>8.2f}{:>13.0f}{:>8.2f}{:>7.2f}\n", scene.name, got.density,
               got.bad1, got.bad3, scene.libelas_density, scene.libelas_bad1, scene.libelas_bad3);
    EXPECT_GE(got.density, scene.libelas_density) << scene.name;
    EXPECT_LE(got.bad1, scene.libelas_bad1 + 0.2) << scene.name;
    EXPECT_LE(got.bad3, scene.libelas_bad3 + 0.2) << scene.name;
    more_bad1 += got.bad1 - scene.libelas_bad1;
    more_bad3 += got.bad3 - scene.libelas_bad3;
  }
  EXPECT_LT(more_bad1, 0) << "on average";
  EXPECT_LT(more_bad3, 0) << "on average";
}

TEST(DepthData, MiddleburySettingFillsThePicture) {
  const char* data = std::getenv("PARTITA_DATA");
  if (data == nullptr) GTEST_SKIP() << "PARTITA_DATA is not set: no real pictures to match";
  const Scene& scene = kScenes[0];
  const Accuracy got = measure(std::string(data) + "/", scene, setting("middlebury"));
  fmt::print("{} filled: density {:.1f}, bad-1 {:.2f}, bad-3 {:.2f}\n", scene.name, got.density,
             got.bad1, got.bad3);
  EXPECT_EQ(got.density, 100);
  EXPECT_LE(got.bad3, 12);
}

}  // namespace
}  // namespace partita::depth
