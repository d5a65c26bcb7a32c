#include "host/tasks/depth/planes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "host/tasks/depth/geometry.h"

namespace partita::depth {
namespace {

/// a / b to the nearest integer, halves away from zero.
std::int64_t rounded_div(std::int64_t a, std::int64_t b) {
  const std::int64_t magnitude = (2 * std::abs(a) + std::abs(b)) / (2 * std::abs(b));
  return (a < 0) != (b < 0) ? -magnitude : magnitude;
}

struct Corner {
  std::int64_t u;
  std::int64_t v;
  std::int64_t d;
};

/// Slopes by Cramer's rule from the corners' differences.
std::array<std::int32_t, kPlaneEntries> plane_through(const Corner& a, const Corner& b,
                                                      const Corner& c, std::int64_t twice_area) {
  const std::int64_t along_u = (b.d - a.d) * (c.v - a.v) - (c.d - a.d) * (b.v - a.v);
  const std::int64_t along_v = (b.u - a.u) * (c.d - a.d) - (c.u - a.u) * (b.d - a.d);
  const std::int64_t slope_u = rounded_div(along_u * 65536, twice_area);
  const std::int64_t slope_v = rounded_div(along_v * 65536, twice_area);
  if (std::abs(slope_u) >= kSteepestU || std::abs(slope_v) >= kSteepestV) return {0, 0, 0, 0};
  return {static_cast<std::int32_t>(slope_u), static_cast<std::int32_t>(slope_v),
          static_cast<std::int32_t>(a.d), 1};
}

/// The view's points and, beside them, their disparities, by row and column without duplicates.
void view_points(std::span<const SupportPoint> points, bool right, std::vector<MeshPoint>& where,
                 std::vector<std::int16_t>& disparity) {
  std::vector<SupportPoint> moved(points.begin(), points.end());
  for (SupportPoint& p : moved) p.u = static_cast<std::int16_t>(p.u - (right ? p.d : 0));
  std::stable_sort(moved.begin(), moved.end(), [](const SupportPoint& a, const SupportPoint& b) {
    return a.v != b.v ? a.v < b.v : a.u < b.u;
  });
  for (const SupportPoint& p : moved) {
    if (!where.empty() && where.back() == MeshPoint{p.u, p.v}) continue;
    where.push_back({p.u, p.v});
    disparity.push_back(p.d);
  }
}

}  // namespace

std::vector<SupportPoint> add_corners(std::span<const SupportPoint> points, Size size) {
  std::vector<SupportPoint> all(points.begin(), points.end());
  if (points.size() < 3) return all;
  const auto right = static_cast<std::int16_t>(size.width - 1);
  const auto bottom = static_cast<std::int16_t>(size.height - 1);
  for (const MeshPoint corner : {MeshPoint{0, 0}, {0, bottom}, {right, 0}, {right, bottom}}) {
    const auto away = [&](const SupportPoint& p) {
      const int du = p.u - corner.x;
      const int dv = p.v - corner.y;
      return du * du + dv * dv;
    };
    const auto nearest = std::min_element(
        points.begin(), points.end(),
        [&](const SupportPoint& a, const SupportPoint& b) { return away(a) < away(b); });
    all.push_back({corner.x, corner.y, nearest->d, 0});
    if (corner.x == 0) continue;
    all.push_back({static_cast<std::int16_t>(right + nearest->d), corner.y, nearest->d, 0});
  }
  return all;
}

Mesh make_mesh(std::span<const SupportPoint> points, bool right) {
  std::vector<MeshPoint> where;
  std::vector<std::int16_t> disparity;
  view_points(points, right, where, disparity);
  Mesh mesh;
  for (const Triangle& triangle : delaunay(where)) {
    Triangle sorted = triangle;  // indices follow row and column
    std::sort(sorted.begin(), sorted.end());
    std::array<Corner, 3> c;
    for (std::size_t k = 0; k < 3; ++k) {
      c[k] = {where[sorted[k]].x, where[sorted[k]].y, disparity[sorted[k]]};
      mesh.corners.push_back(where[sorted[k]].x);
      mesh.corners.push_back(where[sorted[k]].y);
    }
    mesh.corners.insert(mesh.corners.end(), 2, 0);
    const std::int64_t twice_area =
        (c[1].u - c[0].u) * (c[2].v - c[0].v) - (c[2].u - c[0].u) * (c[1].v - c[0].v);
    const auto plane = plane_through(c[0], c[1], c[2], twice_area);
    mesh.planes.insert(mesh.planes.end(), plane.begin(), plane.end());
    mesh.spans += c[2].v - c[0].v;
    mesh.overlaps += (c[2].v - 1) / kBand - c[0].v / kBand + 1;
    mesh.covered += std::abs(twice_area);
    ++mesh.triangles;
  }
  mesh.covered /= 2;
  return mesh;
}

std::vector<std::uint16_t> prior_energies(double beta, double gamma, double sigma, int radius) {
  std::vector<std::uint16_t> table(static_cast<std::size_t>(prior_entries(radius)));
  const auto entry = [&](double bonus) {
    const double energy = kEnergyScale * std::log((gamma + 1) / (gamma + bonus)) / beta;
    return static_cast<std::uint16_t>(std::min(65535.0, std::floor(energy + 0.5)));
  };
  for (std::size_t i = 0; i + 1 < table.size(); ++i) {
    const double distance = static_cast<double>(i) / (1 << kPlaneBits);
    table[i] = entry(std::exp(-distance * distance / (2 * sigma * sigma)));
  }
  table.back() = entry(0);
  return table;
}

}  // namespace partita::depth
