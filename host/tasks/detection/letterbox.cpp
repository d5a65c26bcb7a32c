#include "host/tasks/detection/letterbox.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace partita::detection {

namespace {

constexpr std::int64_t kOne = 2048;  // a weight of one
constexpr float kBar = 0.5F;

/// Between which two source pixels a target pixel's centre lies; the weight of the second.
struct Tap {
  int first = 0, second = 0;
  int weight = 0;
};

std::vector<Tap> taps(int source, int target) {
  std::vector<Tap> result(static_cast<std::size_t>(target));
  for (int i = 0; i < target; ++i) {
    // (i + 1/2) * source / target - 1/2 in units of 1/2048, rounded to nearest.
    const std::int64_t numerator = (2 * std::int64_t{i} + 1) * source - target;
    const std::int64_t position = (numerator * kOne + target) / (2 * std::int64_t{target});
    const std::int64_t clamped =
        std::clamp<std::int64_t>(numerator < 0 ? 0 : position, 0, (source - 1) * kOne);
    Tap& tap = result[static_cast<std::size_t>(i)];
    tap.first = static_cast<int>(clamped / kOne);
    tap.second = std::min(tap.first + 1, source - 1);
    tap.weight = static_cast<int>(clamped % kOne);
  }
  return result;
}

using Row = std::vector<int>;  // three channels a pixel, times 2048

void resize_row(const sensing::Rgb* in, const std::vector<Tap>& columns, Row& out) {
  int* to = out.data();
  for (const Tap& c : columns) {
    const sensing::Rgb a = in[c.first];
    const sensing::Rgb b = in[c.second];
    const int wa = static_cast<int>(kOne) - c.weight;
    *to++ = a.r * wa + b.r * c.weight;
    *to++ = a.g * wa + b.g * c.weight;
    *to++ = a.b * wa + b.b * c.weight;
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
    const int wb = tap.weight;
    const int wa = static_cast<int>(kOne) - wb;
    for (std::size_t i = 0; i < upper.size(); ++i) {
      const int sum = upper[i] * wa + lower[i] * wb;  // at most 255 * 2^22
      to[i] = kLevels[static_cast<std::size_t>((sum + (1 << 21)) >> 22)];
    }
  }
}

}  // namespace partita::detection
