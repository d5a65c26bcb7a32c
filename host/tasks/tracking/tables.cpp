#include "host/tasks/tracking/tables.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace partita::tracking {

std::vector<float> twiddle_table(int cells) {
  std::vector<float> table(static_cast<std::size_t>(cells));
  for (int j = 0; j < cells / 2; ++j) {
    const double angle = 2 * std::numbers::pi * j / cells;
    table[static_cast<std::size_t>(j)] = static_cast<float>(std::cos(angle));
    table[static_cast<std::size_t>(j + cells / 2)] = static_cast<float>(std::sin(angle));
  }
  return table;
}

std::vector<float> taper_table(int cells) {
  std::vector<float> table(static_cast<std::size_t>(cells));
  for (int i = 0; i < cells; ++i) {
    table[static_cast<std::size_t>(i)] =
        static_cast<float>(0.5 - 0.5 * std::cos(2 * std::numbers::pi * (i + 0.5) / cells));
  }
  return table;
}

std::vector<float> label_plane(int cells, double deviation) {
  std::vector<float> plane;
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      const double dx = std::min(x, cells - x);
      const double dy = std::min(y, cells - y);
      plane.push_back(
          static_cast<float>(std::exp(-0.5 * (dx * dx + dy * dy) / (deviation * deviation))));
    }
  }
  return plane;
}

}  // namespace partita::tracking
