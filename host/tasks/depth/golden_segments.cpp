// Golden references of what is done with the matched disparities: segments, gaps, filters.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include "host/tasks/depth/geometry.h"
#include "host/tasks/depth/golden.h"

namespace partita::depth {
namespace {

bool alike(int a, int b, int similarity) {
  return a != 0 && b != 0 && std::abs(a - b) <= similarity;
}

/// Floods the segment of pixel `seed` inside rows [top, bottom): all its pixels, in any order.
std::vector<std::size_t> flood(Size size, std::span<const std::uint16_t> map, int similarity,
                               int top, int bottom, std::size_t seed, std::vector<bool>& seen) {
  const auto width = static_cast<std::size_t>(size.width);
  std::vector<std::size_t> segment{seed};
  seen[seed] = true;
  for (std::size_t k = 0; k < segment.size(); ++k) {
    const std::size_t i = segment[k];
    const auto x = static_cast<int>(i % width);
    const auto y = static_cast<int>(i / width);
    const auto visit = [&](bool inside, std::size_t other) {
      if (!inside || seen[other] || !alike(map[i], map[other], similarity)) return;
      seen[other] = true;
      segment.push_back(other);
    };
    visit(x > 0, i - 1);
    visit(x + 1 < size.width, i + 1);
    visit(y > top, i - width);
    visit(y + 1 < bottom, i + width);
  }
  return segment;
}

bool at_border(Size size, std::size_t i) {
  const auto y = static_cast<std::int64_t>(i / static_cast<std::size_t>(size.width));
  const bool first = y % kBand == 0 && y > 0;
  const bool last = y % kBand == kBand - 1 && y + 1 < size.height;
  return first || last;
}

}  // namespace

void golden_segments(Size size, std::span<const std::uint16_t> map, int similarity,
                     std::span<std::int32_t> labels, std::span<std::int32_t> sizes) {
  std::fill(labels.begin(), labels.end(), -1);
  std::fill(sizes.begin(), sizes.end(), 0);
  std::vector<bool> seen(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] == 0 || seen[i]) continue;
    const int y = static_cast<int>(i / static_cast<std::size_t>(size.width));
    const int top = y / static_cast<int>(kBand) * static_cast<int>(kBand);
    const int bottom = std::min(top + static_cast<int>(kBand), size.height);
    const auto segment = flood(size, map, similarity, top, bottom, i, seen);
    for (const std::size_t k : segment) labels[k] = static_cast<std::int32_t>(i);
    sizes[i] = static_cast<std::int32_t>(segment.size());
  }
}

void golden_join_segments(Size size, std::span<const std::uint16_t> map, int similarity,
                          std::span<std::int32_t> labels, std::span<std::int32_t> sizes) {
  std::vector<bool> seen(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i] == 0 || seen[i]) continue;
    const auto segment = flood(size, map, similarity, 0, size.height, i, seen);
    std::vector<std::size_t> firsts;  // of the parts in the bands that touch a border
    for (const std::size_t k : segment) {
      if (!at_border(size, k)) continue;
      firsts.push_back(static_cast<std::size_t>(labels[k]));
    }
    for (const std::size_t k : segment) {
      if (at_border(size, k)) labels[k] = static_cast<std::int32_t>(i);
    }
    for (const std::size_t k : firsts) {
      labels[k] = static_cast<std::int32_t>(i);
      if (k != i) sizes[k] = 0;
    }
    if (!firsts.empty()) sizes[i] = static_cast<std::int32_t>(segment.size());
  }
}

void golden_remove_speckles(std::span<const std::int32_t> labels,
                            std::span<const std::int32_t> sizes, int least,
                            std::span<std::uint16_t> map) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (labels[i] < 0) continue;
    const std::int32_t segment = labels[static_cast<std::size_t>(labels[i])];
    if (sizes[static_cast<std::size_t>(segment)] < least) map[i] = 0;
  }
}

void golden_fill_gaps(Size size, bool vertical, int gap, bool extend,
                      std::span<std::uint16_t> map) {
  const int lines = vertical ? size.width : size.height;
  const int length = vertical ? size.height : size.width;
  for (int line = 0; line < lines; ++line) {
    const auto at = [&](int k) -> std::uint16_t& {
      const int i = vertical ? k * size.width + line : line * size.width + k;
      return map[static_cast<std::size_t>(i)];
    };
    std::vector<int> places;  // those with a disparity
    for (int k = 0; k < length; ++k) {
      if (at(k) != 0) places.push_back(k);
    }
    if (places.empty()) continue;
    for (std::size_t n = 0; n + 1 < places.size(); ++n) {
      if (places[n + 1] - places[n] - 1 > gap) continue;
      const int a = at(places[n]);
      const int b = at(places[n + 1]);
      const int between = std::abs(a - b) < 3 * 256 ? (a + b) / 2 : std::min(a, b);
      for (int k = places[n] + 1; k < places[n + 1]; ++k) {
        at(k) = static_cast<std::uint16_t>(between);
      }
    }
    if (!extend) continue;
    const int first = places.front();
    const int last = places.back();
    for (int k = std::max(first - gap, 0); k < first; ++k) at(k) = at(first);
    for (int k = last + 1; k < std::min(last + 1 + gap, length); ++k) at(k) = at(last);
  }
}

namespace {

/// Calls `filter` with the taps of every pixel that is far enough from its line's ends; copies the
/// others, and those without a disparity.
template <int Reach, typename Filter>
void along_lines(Size size, bool vertical, std::span<const std::uint16_t> map,
                 std::span<std::uint16_t> out, const Filter& filter) {
  const int stride = vertical ? size.width : 1;
  const int length = vertical ? size.height : size.width;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int i = y * size.width + x;
      const int place = vertical ? y : x;
      out[static_cast<std::size_t>(i)] = map[static_cast<std::size_t>(i)];
      if (place < Reach || place >= length - Reach || map[static_cast<std::size_t>(i)] == 0)
        continue;
      std::array<int, 2 * Reach + 1> taps;
      for (int k = -Reach; k <= Reach; ++k) {
        taps[static_cast<std::size_t>(k + Reach)] = map[static_cast<std::size_t>(i + k * stride)];
      }
      out[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(filter(taps));
    }
  }
}

}  // namespace

void golden_adaptive_mean(Size size, bool vertical, std::span<const std::uint16_t> map,
                          std::span<std::uint16_t> out) {
  along_lines<4>(size, vertical, map, out, [](const std::array<int, 9>& taps) {
    std::int64_t weights = 0;
    std::int64_t sum = 0;
    for (const int tap : taps) {
      const int weight = tap == 0 ? 0 : std::max(1024 - std::abs(tap - taps[4]), 0);
      weights += weight;
      sum += std::int64_t{weight} * tap;
    }
    return (2 * sum + weights) / (2 * weights);
  });
}

void golden_median(Size size, bool vertical, std::span<const std::uint16_t> map,
                   std::span<std::uint16_t> out) {
  along_lines<3>(size, vertical, map, out, [](std::array<int, 7> taps) {
    std::nth_element(taps.begin(), taps.begin() + 3, taps.end());
    return taps[3];
  });
}

}  // namespace partita::depth
