#include "host/tasks/depth/delaunay.h"

#include <algorithm>
#include <cstddef>

#include <boost/polygon/voronoi.hpp>

namespace boost::polygon {

template <>
struct geometry_concept<partita::depth::MeshPoint> {
  using type = point_concept;
};

template <>
struct point_traits<partita::depth::MeshPoint> {
  using coordinate_type = int;
  static coordinate_type get(const partita::depth::MeshPoint& point, orientation_2d orientation) {
    return orientation == HORIZONTAL ? point.x : point.y;
  }
};

}  // namespace boost::polygon

namespace partita::depth {
namespace {

/// The triangles of the polygon whose corners lie on one circle, in order around it.
void fan(std::span<const std::uint32_t> corners, std::vector<Triangle>& triangles) {
  const auto first =
      static_cast<std::size_t>(std::min_element(corners.begin(), corners.end()) - corners.begin());
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    Triangle triangle{corners[first], corners[(first + k) % corners.size()],
                      corners[(first + k + 1) % corners.size()]};
    std::sort(triangle.begin(), triangle.end());
    triangles.push_back(triangle);
  }
}

}  // namespace

std::vector<Triangle> delaunay(std::span<const MeshPoint> points) {
  std::vector<Triangle> triangles;
  if (points.size() < 3) return triangles;
  boost::polygon::voronoi_diagram<double> diagram;
  boost::polygon::construct_voronoi(points.begin(), points.end(), &diagram);

  triangles.reserve(2 * points.size());
  std::vector<std::uint32_t> corners;
  for (const auto& vertex : diagram.vertices()) {
    corners.clear();
    const auto* edge = vertex.incident_edge();
    do {
      corners.push_back(static_cast<std::uint32_t>(edge->cell()->source_index()));
      edge = edge->rot_next();
    } while (edge != vertex.incident_edge());
    fan(corners, triangles);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

}  // namespace partita::depth
