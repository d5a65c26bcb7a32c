// Delaunay triangulation of pixels, by Boost.Polygon's Voronoi diagram (integer coordinates, exact
// predicates). Support points lie on a grid, so four or more of them often share a circle; the
// triangulation is made unique there: the polygon of such points is fanned out from its first
// corner by row and column.
#ifndef PARTITA_HOST_TASKS_DEPTH_DELAUNAY_H
#define PARTITA_HOST_TASKS_DEPTH_DELAUNAY_H

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace partita::depth {

struct MeshPoint {
  std::int16_t x;
  std::int16_t y;
  bool operator==(const MeshPoint&) const = default;
};

/// Indices into the points.
using Triangle = std::array<std::uint32_t, 3>;

/// `points` are distinct and in order of row (y), then column (x). The triangles come in order of
/// their smallest index, then the next. Empty if there are fewer than three points or all lie on
/// one line.
std::vector<Triangle> delaunay(std::span<const MeshPoint> points);

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_DELAUNAY_H
