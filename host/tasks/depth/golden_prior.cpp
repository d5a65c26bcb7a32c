#include <algorithm>
#include <array>
#include <cstddef>

#include "host/tasks/depth/golden.h"
#include "host/tasks/depth/planes.h"

namespace partita::depth {

void golden_grid_prior(Size size, Size grid_size, std::span<const std::int16_t> grid, int step,
                       int max_disparity, bool right, std::span<std::uint16_t> counts,
                       std::span<std::uint8_t> lists) {
  const int columns = (size.width + kCell - 1) / kCell;
  const int rows = (size.height + kCell - 1) / kCell;
  for (int cy = 0; cy < rows; ++cy) {
    for (int cx = 0; cx < columns; ++cx) {
      std::array<bool, 258> seen{};  // index d + 1: d - 1 and d + 1 always have a place
      for (int j = 0; j < grid_size.height; ++j) {
        if (j * step / kCell != cy) continue;
        for (int i = 0; i < grid_size.width; ++i) {
          const int d = grid[static_cast<std::size_t>(j * grid_size.width + i)];
          const int u = i * step - (right ? d : 0);
          if (d < 0 || u < 0 || u / kCell != cx) continue;
          for (int k = d; k <= d + 2; ++k) seen[static_cast<std::size_t>(k)] = true;
        }
      }
      const auto cell = static_cast<std::size_t>(cy * columns + cx);
      std::uint16_t n = 0;
      for (int d = 0; d <= max_disparity; ++d) {
        if (!seen[static_cast<std::size_t>(d + 1)]) continue;
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
