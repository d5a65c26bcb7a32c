#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include "host/tasks/depth/golden.h"

namespace partita::depth {
namespace {

int l1(const std::uint8_t* a, const std::uint8_t* b) {
  int sum = 0;
  for (int k = 0; k < kDescriptorBytes; ++k) sum += std::abs(a[k] - b[k]);
  return sum;
}

int contrast(const std::uint8_t* a) {
  int sum = 0;
  for (int k = 0; k < kDescriptorBytes; ++k) sum += std::abs(a[k] - 128);
  return sum;
}

int floor_div(int a, int b) {  // b > 0
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

/// One pixel: its view's descriptor, and the other view's row.
struct Pixel {
  const std::uint8_t* mine;
  const std::uint8_t* row;
  int x;
  int width;
  const DenseRules& rules;

  bool possible(int d) const {
    const int column = rules.right ? x + d : x - d;
    return d >= 0 && d <= rules.max_disparity && column >= 0 && column < width;
  }
  int distance(int d) const {
    return l1(mine, row + (rules.right ? x + d : x - d) * kDescriptorBytes);
  }
};

/// Where between its neighbours the parabola through three distances has its least value, 1/256 px;
/// 0 if the disparity is not a minimum.
int refinement(const Pixel& pixel, int d) {
  if (!pixel.possible(d - 1) || !pixel.possible(d + 1)) return 0;
  const int before = pixel.distance(d - 1);
  const int here = pixel.distance(d);
  const int behind = pixel.distance(d + 1);
  const int curvature = before - 2 * here + behind;
  if (before < here || behind < here || curvature == 0) return 0;
  return floor_div(128 * (before - behind), curvature);
}

}  // namespace

void golden_dense_match(Size size, std::span<const std::uint8_t> own,
                        std::span<const std::uint8_t> other, std::span<const std::int16_t> map,
                        std::span<const std::uint16_t> counts, std::span<const std::uint8_t> lists,
                        std::span<const std::uint16_t> prior, const DenseRules& rules,
                        std::span<std::uint16_t> disparities) {
  const int columns = (size.width + rules.cell - 1) / rules.cell;
  const auto list_length = static_cast<std::size_t>(rules.max_disparity + 1);
  std::size_t i = 0;
  for (int y = 0; y < size.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width);
    for (int x = 0; x < size.width; ++x, ++i) {
      const Pixel pixel{&own[i * kDescriptorBytes], &other[row * kDescriptorBytes], x, size.width,
                        rules};
      int best = -1;
      int best_energy = INT32_MAX;
      const auto consider = [&](int d, int penalty) {
        if (!pixel.possible(d)) return;
        const int energy = kEnergyScale * pixel.distance(d) + penalty;
        if (energy < best_energy || (energy == best_energy && d < best)) {
          best_energy = energy;
          best = d;
        }
      };
      if (map[i] != kNoPlane) {
        const int floor = map[i] >> kPlaneBits;
        for (int d = floor - rules.radius + 1; d <= floor + rules.radius; ++d) {
          consider(d, prior[static_cast<std::size_t>(std::abs((d << kPlaneBits) - map[i]))]);
        }
      }
      const auto cell = static_cast<std::size_t>((y / rules.cell) * columns + x / rules.cell);
      for (std::size_t n = 0; n < counts[cell]; ++n) {
        consider(lists[cell * list_length + n], prior.back());
      }
      disparities[i] = 0;
      if (best < 0 || contrast(pixel.mine) < rules.texture) continue;
      const int offset = rules.right ? 0 : refinement(pixel, best);
      disparities[i] = static_cast<std::uint16_t>(std::max(1, best * 256 + offset));
    }
  }
}

void golden_consistency(Size size, std::span<const std::uint16_t> left,
                        std::span<const std::uint16_t> right, int lr_threshold,
                        std::span<std::uint16_t> out) {
  std::size_t i = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x, ++i) {
      out[i] = 0;
      const int d = left[i];
      const int whole = (d + 254) >> 8;  // a disparity of zero is stored as 1
      if (d == 0 || whole > x) continue;
      const int back = right[i - static_cast<std::size_t>(whole)];
      if (back == 0 || std::abs(back - d) > lr_threshold * 256) continue;
      out[i] = static_cast<std::uint16_t>(d);
    }
  }
}

}  // namespace partita::depth
