#include "host/app/stereo_pair.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/io/image.h"
#include "host/runtime/error.h"

namespace partita::app {
namespace {

using sensing::GrayImage;

/// Fewer disparities than this are few: pictures that belong together fill most of the map.
constexpr double kLowDensity = 0.3;
/// Swapped back, a pair has at least this many times the disparities.
constexpr double kSwappedGain = 2;

GrayImage read_converted(const std::string& path, std::vector<std::string>& conversions) {
  io::GrayRead read = io::read_gray(path);
  if (!read.converted.empty()) {
    conversions.push_back(fmt::format("{}: {}, converted to 8-bit gray", path, read.converted));
  }
  return std::move(read.image);
}

void doubt_picture(const std::string& path, const GrayImage& image, std::vector<std::string>& list) {
  const auto [least, most] = std::minmax_element(image.pixels.begin(), image.pixels.end());
  if (*least == *most) {
    list.push_back(fmt::format("{}: level {} in every pixel, nothing to match", path, *least));
  }
}

}  // namespace

StereoPair read_pair(const std::string& left, const std::string& right) {
  StereoPair pair{.left_path = left, .right_path = right};
  pair.left = read_converted(left, pair.conversions);
  pair.right = read_converted(right, pair.conversions);
  if (pair.left.width != pair.right.width || pair.left.height != pair.right.height) {
    throw Error(fmt::format("{} is {} x {} and {} is {} x {}, expected pictures of one size", left,
                            pair.left.width, pair.left.height, right, pair.right.width,
                            pair.right.height));
  }
  return pair;
}

std::vector<std::string> doubts(const StereoPair& pair, const depth::DisparityMap& map,
                                depth::Depth& depth) {
  std::vector<std::string> list;
  doubt_picture(pair.left_path, pair.left, list);
  doubt_picture(pair.right_path, pair.right, list);
  if (!list.empty()) return list;
  if (pair.left == pair.right) {
    list.push_back("the two pictures are the same: every disparity is zero");
    return list;
  }
  const double density = map.density();
  if (density >= kLowDensity) return list;
  if (map.too_few_support_points) {
    list.push_back(fmt::format("{} support points, which span no triangle: the map is empty (no "
                               "texture, a pattern that repeats, or pictures that do not belong "
                               "together)",
                               map.counts.support_points));
  } else {
    list.push_back(fmt::format("only {:.1f} % of the pixels have a disparity, from {} support "
                               "points: what is there may be wrong",
                               100 * density, map.counts.support_points));
  }
  const double swapped = depth.process(pair.right, pair.left, 0).density();
  if (swapped >= kLowDensity && swapped > kSwappedGain * density) {
    list.push_back(fmt::format("the pictures look swapped: the other way round {:.1f} % of the "
                               "pixels have a disparity",
                               100 * swapped));
  }
  return list;
}

}  // namespace partita::app
