#include "host/tasks/frontend/layout.h"

#include <algorithm>

namespace partita::frontend {

Size level_size(Size image, int level) {
  return level == 0 ? image : Size{image.width * 5 / 6, image.height * 5 / 6};
}

Grid make_grid(Size level, int cell) {
  const auto count = [cell](int length) { return (length - 2 * kBorder + cell - 1) / cell; };
  return {cell, count(level.width), count(level.height)};
}

Grid finest_grid(Size level, int quota) {
  for (int cell = 2;; cell += 2) {
    const Grid grid = make_grid(level, cell);
    if (grid.cells() * kPerCell <= std::max(quota, kPerCell)) return grid;
  }
}

Grids make_grids(Size image, int max_features) {
  // Level 1 has (5/6)^2 of level 0's area, and the same share of the features: 36/61 and 25/61.
  const int first = max_features * 36 / 61;
  return {image,
          {finest_grid(level_size(image, 0), first),
           finest_grid(level_size(image, 1), max_features - first)}};
}

int to_original_q8(int value, int level) {
  return level == 0 ? value * 256 : (value * 78643 + 6682) >> 8;
}

}  // namespace partita::frontend
