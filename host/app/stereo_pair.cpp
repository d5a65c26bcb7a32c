#include "host/app/stereo_pair.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/io/image.h"
#include "host/runtime/error.h"

namespace partita::app {
namespace {

using sensing::GrayImage;

// Pictures that belong together have a disparity for four pixels of five and support at every
// eighth point of the grid (at every thirtieth, where one plane fills the picture); the right ones
// the wrong way round, or of two places, for a fifth of the pixels and at one point of a hundred.
// With a looser ratio test and all gaps filled ("middlebury") the wrong ones have a disparity
// everywhere, from two or three points of a hundred.
constexpr double kLowDensity = 0.3;
constexpr double kLowSupport = 0.03;
constexpr double kSuspiciousSupport = 0.05;
/// Swapped back, a pair has at least this share and this many times the support points.
constexpr double kSwappedSupport = 0.03;
constexpr double kSwappedGain = 2;

GrayImage read_converted(const std::string& path, std::vector<std::string>& conversions) {
  io::GrayRead read = io::read_gray(path);
  if (!read.converted.empty()) {
    conversions.push_back(fmt::format("{}: {}, converted to 8-bit gray", path, read.converted));
    // Cameras of 10 or 12 bits leave the upper ones of 16 empty.
    constexpr int kFewLevels = 16;
    const int most = *std::max_element(read.image.pixels.begin(), read.image.pixels.end());
    if (most < kFewLevels) {
      conversions.back() +=
          fmt::format(", of which it uses levels up to {}: scale it to the full range first", most);
    }
  }
  return std::move(read.image);
}

void doubt_picture(const std::string& path, const GrayImage& image,
                   std::vector<std::string>& list) {
  const auto [least, most] = std::minmax_element(image.pixels.begin(), image.pixels.end());
  if (*least == *most) {
    list.push_back(fmt::format("{}: level {} in every pixel, nothing to match", path, *least));
  }
}

/// Of the points of the grid, those that became support points.
double support_share(const depth::DisparityMap& map, const depth::DepthParameters& parameters) {
  const int step = parameters.candidate_step;
  const int grid = std::max(1, (map.width / step) * (map.height / step));
  return static_cast<double>(map.counts.support_points) / grid;
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
                                const depth::DepthParameters& parameters, depth::Depth& depth) {
  std::vector<std::string> list;
  doubt_picture(pair.left_path, pair.left, list);
  doubt_picture(pair.right_path, pair.right, list);
  if (!list.empty()) return list;
  if (pair.left == pair.right) {
    list.push_back("the two pictures are the same: there is no disparity to find");
    return list;
  }
  const std::int64_t points = map.counts.support_points;
  const double share = support_share(map, parameters);
  const double density = map.density();
  if (map.too_few_support_points) {
    list.push_back(
        fmt::format("{} support points, which span no triangle: the map is empty (no "
                    "texture, a pattern that repeats, or pictures that do not belong "
                    "together)",
                    points));
  } else if (density < kLowDensity || share < kLowSupport) {
    list.push_back(
        fmt::format("{} support points ({:.1f} of 100 grid points) and a disparity for {:.1f} % of "
                    "the pixels, which is little: what is there may be wrong",
                    points, 100 * share, 100 * density));
  }
  if (density >= kLowDensity && share >= kSuspiciousSupport) return list;
  const depth::DisparityMap swapped = depth.process(pair.right, pair.left, 0);
  const double swapped_share = support_share(swapped, parameters);
  if (swapped_share >= kSwappedSupport && swapped_share > kSwappedGain * share) {
    list.push_back(
        fmt::format("the pictures look swapped: the other way round there are {} support points "
                    "instead of {}",
                    swapped.counts.support_points, points));
  }
  return list;
}

}  // namespace partita::app
