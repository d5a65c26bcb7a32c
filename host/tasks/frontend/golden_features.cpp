#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "host/tasks/frontend/golden.h"
#include "host/tasks/frontend/pattern.h"

namespace partita::frontend::golden {
namespace {

/// A corner beats a neighbour by a greater score; of equal ones the first in reading order wins.
bool survives(const GrayImage& score, int x, int y) {
  const int own = score.at(x, y);
  if (own == 0) return false;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      const int other = score.at(x + dx, y + dy);
      const bool other_first = dy < 0 || (dy == 0 && dx < 0);
      if (other > own || (other == own && other_first)) return false;
    }
  }
  return true;
}

}  // namespace

std::uint32_t corner_key(int score, int x, int y) {
  return (static_cast<std::uint32_t>(score) << 24) | (static_cast<std::uint32_t>(4095 - y) << 12) |
         static_cast<std::uint32_t>(4095 - x);
}

std::pair<int, int> key_position(std::uint32_t key) {
  return {4095 - static_cast<int>(key & 4095u), 4095 - static_cast<int>((key >> 12) & 4095u)};
}

std::vector<std::uint32_t> select_cells(const GrayImage& score, int cell, int threshold_high) {
  const Grid grid = make_grid({score.width, score.height}, cell);
  std::vector<std::vector<std::uint32_t>> found(static_cast<std::size_t>(grid.cells()));
  for (int y = kBorder; y < score.height - kBorder; ++y) {
    for (int x = kBorder; x < score.width - kBorder; ++x) {
      if (!survives(score, x, y)) continue;
      const int index = (y - kBorder) / cell * grid.columns + (x - kBorder) / cell;
      found[static_cast<std::size_t>(index)].push_back(corner_key(score.at(x, y), x, y));
    }
  }
  std::vector<std::uint32_t> slots;
  for (std::vector<std::uint32_t>& keys : found) {
    std::sort(keys.begin(), keys.end(), std::greater<>());
    keys.resize(kPerCell, 0);
    const auto high = [&](std::uint32_t key) {
      return static_cast<int>(key >> 24) > threshold_high;
    };
    const bool any_high = high(keys.front());
    for (std::uint32_t key : keys) slots.push_back(any_high && !high(key) ? 0 : key);
  }
  return slots;
}

FeatureList compact(std::span<const std::uint32_t> slots, int cells_level0) {
  FeatureList list;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const int cell = static_cast<int>(i) / kPerCell;
    if (i % kPerCell == 0) list.cell_start.push_back(static_cast<int>(list.keypoints.size()));
    if (slots[i] == 0) continue;
    const int level = cell < cells_level0 ? 0 : 1;
    const auto [x, y] = key_position(slots[i]);
    list.keypoints.push_back({to_original_q8(x, level), to_original_q8(y, level), x | (y << 16),
                              static_cast<int>(slots[i] >> 24) | (level << 16)});
  }
  list.cell_start.push_back(static_cast<int>(list.keypoints.size()));
  return list;
}

std::pair<int, int> moments(const GrayImage& image, int x, int y) {
  int m10 = 0;
  int m01 = 0;
  for (int dy = -kPatchRadius; dy <= kPatchRadius; ++dy) {
    for (int dx = -kPatchRadius; dx <= kPatchRadius; ++dx) {
      if (dx * dx + dy * dy > kPatchRadius * kPatchRadius) continue;
      m10 += dx * image.at(x + dx, y + dy);
      m01 += dy * image.at(x + dx, y + dy);
    }
  }
  return {m10, m01};
}

int direction_bin(int m10, int m01) {
  // Cross product with the direction of a bin's boundary, rounded to 1/1024.
  const auto cross = [&](int boundary) {
    const double angle = 2 * std::numbers::pi * boundary / kBins;
    return std::lround(1024 * std::cos(angle)) * m01 - std::lround(1024 * std::sin(angle)) * m10;
  };
  for (int bin = 0; bin < kBins; ++bin) {
    if (cross(bin) >= 0 && cross(bin + 1) < 0) return bin;
  }
  return 0;
}

Descriptor describe(const GrayImage& blurred, int x, int y, int bin,
                    std::span<const std::uint16_t> table) {
  const auto pixel = [&](std::uint16_t offset) {
    return blurred.at(x + offset % kPatchStride - kPatchRadius,
                      y + offset / kPatchStride - kPatchRadius);
  };
  Descriptor descriptor{};
  for (std::size_t t = 0; t < kTests; ++t) {
    const std::size_t pair = (static_cast<std::size_t>(bin) * kTests + t) * 2;
    if (pixel(table[pair]) < pixel(table[pair + 1])) descriptor[t / 32] |= 1u << (t % 32);
  }
  return descriptor;
}

}  // namespace partita::frontend::golden
