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

}  // namespace

void golden_dense_match(Size size, std::span<const std::uint8_t> own,
                        std::span<const std::uint8_t> other, std::span<const std::int16_t> map,
                        std::span<const std::uint16_t> counts, std::span<const std::uint8_t> lists,
                        std::span<const std::uint16_t> prior, int max_disparity, bool right,
                        int texture, std::span<std::int16_t> disparities) {
  const int columns = (size.width + kCell - 1) / kCell;
  std::size_t i = 0;
  for (int y = 0; y < size.height; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width);
    for (int x = 0; x < size.width; ++x, ++i) {
      disparities[i] = -1;
      const std::uint8_t* mine = &own[i * kDescriptorBytes];
      if (contrast(mine) < texture) continue;

      int best_energy = INT32_MAX;
      const auto consider = [&](int d, int penalty) {
        const int column = right ? x + d : x - d;
        if (d < 0 || d > max_disparity || column < 0 || column >= size.width) return;
        const std::size_t there = row + static_cast<std::size_t>(column);
        const int energy = kEnergyScale * l1(mine, &other[there * kDescriptorBytes]) + penalty;
        if (energy < best_energy || (energy == best_energy && d < disparities[i])) {
          best_energy = energy;
          disparities[i] = static_cast<std::int16_t>(d);
        }
      };
      if (map[i] != kNoPlane) {  // the four disparities within 2 px of the plane
        const int floor = map[i] >> kPlaneBits;
        for (int d = floor - 1; d <= floor + 2; ++d) {
          consider(d, prior[static_cast<std::size_t>(std::abs((d << kPlaneBits) - map[i]))]);
        }
      }
      const std::size_t cell = static_cast<std::size_t>((y / kCell) * columns + x / kCell);
      for (std::size_t n = 0; n < counts[cell]; ++n) {
        consider(lists[cell * static_cast<std::size_t>(max_disparity + 1) + n],
                 prior[kPriorEntries - 1]);
      }
    }
  }
}

void golden_consistency(Size size, std::span<const std::int16_t> left,
                        std::span<const std::int16_t> right, int lr_threshold,
                        std::span<std::uint16_t> out) {
  std::size_t i = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x, ++i) {
      out[i] = 0;
      const int d = left[i];
      if (d < 0 || d > x) continue;
      const int back = right[i - static_cast<std::size_t>(d)];
      if (back < 0 || std::abs(back - d) > lr_threshold) continue;
      out[i] = static_cast<std::uint16_t>(std::max(1, d * 256));
    }
  }
}

}  // namespace partita::depth
