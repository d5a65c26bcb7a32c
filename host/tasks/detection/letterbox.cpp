#include "host/tasks/detection/letterbox.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace partita::detection {

namespace {

constexpr int kOne = 2048;  // a weight of one
constexpr float kBar = 0.5F;

/// Between which two source pixels a target pixel's centre lies, and their weights.
struct Tap {
  int first = 0, second = 0;
  int first_weight = kOne, second_weight = 0;
};

std::vector<Tap> taps(int source, int target) {
  const double scale = 1.0 / (static_cast<double>(target) / source);
  std::vector<Tap> result(static_cast<std::size_t>(target));
  for (int i = 0; i < target; ++i) {
    const auto position = static_cast<float>((i + 0.5) * scale - 0.5);
    const float floor = std::floor(position);
    Tap& tap = result[static_cast<std::size_t>(i)];
    if (position < 0) continue;  // the first pixel alone
    tap.first = std::min(static_cast<int>(floor), source - 1);
    tap.second = std::min(tap.first + 1, source - 1);
    if (tap.first == source - 1) continue;  // the last one alone
    const float beyond = position - floor;
    tap.first_weight = static_cast<int>(std::nearbyint((1.0F - beyond) * kOne));
    tap.second_weight = static_cast<int>(std::nearbyint(beyond * kOne));
  }
  return result;
}

using Row = std::vector<int>;  // three channels a pixel, times 2048

void resize_row(const sensing::Rgb* in, const std::vector<Tap>& columns, Row& out) {
  int* to = out.data();
  for (const Tap& c : columns) {
    const sensing::Rgb a = in[c.first];
    const sensing::Rgb b = in[c.second];
    *to++ = a.r * c.first_weight + b.r * c.second_weight;
    *to++ = a.g * c.first_weight + b.g * c.second_weight;
    *to++ = a.b * c.first_weight + b.b * c.second_weight;
  }
}

}  // namespace

Placed place(int picture_width, int picture_height, int input_width, int input_height, Fit fit) {
  Placed p{.input_width = input_width,
           .input_height = input_height,
           .picture_width = picture_width,
           .picture_height = picture_height,
           .width = input_width,
           .height = input_height};
  if (fit == Fit::stretch) return p;
  const std::int64_t w = picture_width;
  const std::int64_t h = picture_height;
  if (input_width * h < input_height * w) {
    p.height = static_cast<int>(std::max<std::int64_t>(1, h * input_width / w));
  } else {
    p.width = static_cast<int>(std::max<std::int64_t>(1, w * input_height / h));
  }
  p.left = (input_width - p.width) / 2;
  p.top = (input_height - p.height) / 2;
  return p;
}

void fit_picture(const sensing::ColourImage& picture, const Placed& p, std::vector<float>& out) {
  static const auto kLevels = [] {
    std::array<float, 256> levels{};
    for (int i = 0; i < 256; ++i) levels[static_cast<std::size_t>(i)] = static_cast<float>(i) / 255;
    return levels;
  }();
  const std::size_t stride = 3 * static_cast<std::size_t>(p.input_width);
  out.resize(stride * static_cast<std::size_t>(p.input_height));
  if (p.width < p.input_width || p.height < p.input_height) std::fill(out.begin(), out.end(), kBar);
  const std::vector<Tap> columns = taps(p.picture_width, p.width);
  const std::vector<Tap> rows = taps(p.picture_height, p.height);
  Row upper(3 * columns.size());
  Row lower(upper.size());
  int upper_is = -1;
  int lower_is = -1;
  for (int y = 0; y < p.height; ++y) {
    const Tap& tap = rows[static_cast<std::size_t>(y)];
    if (upper_is != tap.first && lower_is == tap.first) {
      std::swap(upper, lower);
      std::swap(upper_is, lower_is);
    }
    if (upper_is != tap.first) resize_row(picture.row(tap.first), columns, upper);
    upper_is = tap.first;
    if (lower_is != tap.second) resize_row(picture.row(tap.second), columns, lower);
    lower_is = tap.second;
    float* to = out.data() + stride * static_cast<std::size_t>(p.top + y) + 3 * p.left;
    for (std::size_t i = 0; i < upper.size(); ++i) {
      // The steps of rounding are OpenCV's, for the same gray levels.
      const int above = (tap.first_weight * (upper[i] >> 4)) >> 16;
      const int below = (tap.second_weight * (lower[i] >> 4)) >> 16;
      to[i] = kLevels[static_cast<std::size_t>((above + below + 2) >> 2)];
    }
  }
}

}  // namespace partita::detection
