#include <algorithm>
#include <array>
#include <cstddef>

#include "host/tasks/depth/golden.h"
#include "host/tasks/depth/planes.h"

namespace partita::depth {

void golden_grid_seen(Size size, int cell, Size grid_size, std::span<const std::int16_t> grid,
                      int step, int max_disparity, bool right, std::span<std::uint32_t> seen) {
  const int columns = (size.width + cell - 1) / cell;
  std::fill(seen.begin(), seen.end(), 0u);
  for (int j = 0; j < grid_size.height; ++j) {
    for (int i = 0; i < grid_size.width; ++i) {
      const int d = grid[static_cast<std::size_t>(j * grid_size.width + i)];
      const int u = i * step - (right ? d : 0);
      if (d < 0 || u < 0) continue;
      const auto at = static_cast<std::size_t>((j * step / cell) * columns + u / cell);
      for (int k = std::max(d - 1, 0); k <= std::min(d + 1, max_disparity); ++k) {
        seen[at * kSeenWords + static_cast<std::size_t>(k / 32)] |= 1u << (k % 32);
      }
    }
  }
}

void golden_grid_prior(Size cells, std::span<const std::uint32_t> seen, int max_disparity,
                       std::span<std::uint16_t> counts, std::span<std::uint8_t> lists) {
  const auto marked = [&](int cx, int cy, int d) {
    if (cx < 0 || cx >= cells.width || cy < 0 || cy >= cells.height) return false;
    const auto at = static_cast<std::size_t>((cy * cells.width + cx) * kSeenWords + d / 32);
    return ((seen[at] >> (d % 32)) & 1u) != 0;
  };
  for (int cy = 0; cy < cells.height; ++cy) {
    for (int cx = 0; cx < cells.width; ++cx) {
      const auto cell = static_cast<std::size_t>(cy * cells.width + cx);
      std::uint16_t n = 0;
      for (int d = 0; d <= max_disparity; ++d) {
        bool found = false;
        for (int k = 0; k < 9; ++k) found = found || marked(cx + k % 3 - 1, cy + k / 3 - 1, d);
        if (!found) continue;
        lists[cell * static_cast<std::size_t>(max_disparity + 1) + n++] =
            static_cast<std::uint8_t>(d);
      }
      counts[cell] = n;
    }
  }
}

namespace {

int ceil_div(int a, int b) {  // b > 0
  return a >= 0 ? (a + b - 1) / b : -(-a / b);
}

/// First column at or right of the edge from (x0, y0) to (x1, y1) in row y, y0 <= y < y1.
int first_column(int x0, int y0, int x1, int y1, int y) {
  return x0 + ceil_div((x1 - x0) * (y - y0), y1 - y0);
}

}  // namespace

void golden_plane_prior(Size size, std::span<const std::int16_t> corners,
                        std::span<const std::int32_t> planes, int triangles,
                        std::span<std::int16_t> map) {
  std::fill(map.begin(), map.end(), kNoPlane);
  for (int t = 0; t < triangles; ++t) {
    const std::int16_t* c = &corners[static_cast<std::size_t>(t) * kCornerEntries];
    const std::int32_t* plane = &planes[static_cast<std::size_t>(t) * kPlaneEntries];
    // A pixel belongs to the triangle if it is inside, on a left edge or on an upper vertex: rows
    // [top, bottom), columns [left edge, right edge). Each pixel of the mesh has one triangle.
    for (int y = std::max<int>(0, c[1]); y < std::min<int>(size.height, c[5]); ++y) {
      const int along = first_column(c[0], c[1], c[4], c[5], y);
      const int around = y < c[3] ? first_column(c[0], c[1], c[2], c[3], y)
                                  : first_column(c[2], c[3], c[4], c[5], y);
      const int begin = std::max(0, std::min(along, around));
      const int end = std::min(size.width, std::max(along, around));
      for (int x = begin; x < end; ++x) {
        map[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
            static_cast<std::size_t>(x)] = plane_at(plane, x - c[0], y - c[1]);
      }
    }
  }
}

}  // namespace partita::depth
