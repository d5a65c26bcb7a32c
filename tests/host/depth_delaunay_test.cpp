// The triangulation and the planes on it: no OpenCL.
#include <algorithm>
#include <cstdint>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "host/tasks/depth/delaunay.h"
#include "host/tasks/depth/geometry.h"
#include "host/tasks/depth/planes.h"

namespace partita::depth {
namespace {

std::vector<MeshPoint> random_points(std::uint32_t seed, int count, int step) {
  std::mt19937 random(seed);
  std::set<std::pair<int, int>> places;
  while (static_cast<int>(places.size()) < count) {
    places.insert({static_cast<int>(random() % 40) * step, static_cast<int>(random() % 60) * step});
  }
  std::vector<MeshPoint> points;
  for (const auto& [y, x] : places) {
    points.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)});
  }
  return points;
}

/// Twice the signed area.
std::int64_t cross(const MeshPoint& a, const MeshPoint& b, const MeshPoint& c) {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{c.x - a.x} * (b.y - a.y);
}

/// Positive if d lies inside the circle through a, b, c (counterclockwise), exact.
__extension__ using Wide = __int128;
Wide in_circle(const MeshPoint& a, const MeshPoint& b, const MeshPoint& c, const MeshPoint& d) {
  const auto row = [&](const MeshPoint& p) {
    const std::int64_t x = p.x - d.x;
    const std::int64_t y = p.y - d.y;
    return std::array<std::int64_t, 3>{x, y, x * x + y * y};
  };
  const auto p = row(a);
  const auto q = row(b);
  const auto r = row(c);
  return Wide{p[0]} * (q[1] * r[2] - q[2] * r[1]) - Wide{p[1]} * (q[0] * r[2] - q[2] * r[0]) +
         Wide{p[2]} * (q[0] * r[1] - q[1] * r[0]);
}

TEST(Delaunay, NoPointInsideACircumcircleAndTheHullIsCovered) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto points = random_points(seed, 150, seed % 2 == 0 ? 5 : 1);
    const auto triangles = delaunay(points);
    ASSERT_FALSE(triangles.empty());
    std::int64_t area = 0;
    for (const Triangle& t : triangles) {
      MeshPoint a = points[t[0]];
      MeshPoint b = points[t[1]];
      const MeshPoint c = points[t[2]];
      if (cross(a, b, c) < 0) std::swap(a, b);
      ASSERT_GT(cross(a, b, c), 0);
      area += cross(a, b, c);
      for (const MeshPoint& d : points) EXPECT_LE(in_circle(a, b, c, d), 0);
    }
    // The triangles' areas sum up to the convex hull's (Andrew's monotone chain).
    auto sorted = points;
    std::sort(sorted.begin(), sorted.end(), [](const MeshPoint& a, const MeshPoint& b) {
      return a.x != b.x ? a.x < b.x : a.y < b.y;
    });
    std::int64_t hull = 0;
    for (int side = 0; side < 2; ++side) {
      std::vector<MeshPoint> chain;
      for (const MeshPoint& p : sorted) {
        while (chain.size() > 1 && cross(chain[chain.size() - 2], chain.back(), p) <= 0) {
          chain.pop_back();
        }
        chain.push_back(p);
      }
      for (std::size_t i = 1; i < chain.size(); ++i) {
        hull +=
            std::int64_t{chain[i - 1].x} * chain[i].y - std::int64_t{chain[i].x} * chain[i - 1].y;
      }
      std::reverse(sorted.begin(), sorted.end());
    }
    EXPECT_EQ(area, hull);
  }
}

TEST(Delaunay, GridOfCocircularPointsIsFannedFromTheFirstCorner) {
  std::vector<MeshPoint> points;
  for (std::int16_t y = 0; y < 4; ++y) {
    for (std::int16_t x = 0; x < 5; ++x) {
      points.push_back({static_cast<std::int16_t>(5 * x), static_cast<std::int16_t>(5 * y)});
    }
  }
  const auto triangles = delaunay(points);
  ASSERT_EQ(triangles.size(), 2u * 3 * 4);
  for (std::uint32_t j = 0; j < 3; ++j) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t corner = 5 * j + i;
      const Triangle upper{corner, corner + 1, corner + 6};
      const Triangle lower{corner, corner + 5, corner + 6};
      EXPECT_TRUE(std::binary_search(triangles.begin(), triangles.end(), upper));
      EXPECT_TRUE(std::binary_search(triangles.begin(), triangles.end(), lower));
    }
  }
}

TEST(Delaunay, DegenerateInputsGiveNothing) {
  EXPECT_TRUE(delaunay({}).empty());
  const std::vector<MeshPoint> line{{0, 0}, {5, 5}, {10, 10}, {15, 15}};
  EXPECT_TRUE(delaunay(std::span(line).first(1)).empty());
  EXPECT_TRUE(delaunay(std::span(line).first(2)).empty());
  EXPECT_TRUE(delaunay(line).empty());
}

std::vector<SupportPoint> plane_points(int width, int height) {
  std::vector<SupportPoint> points;
  for (int v = 5; v < height; v += 5) {
    for (int u = 5; u < width; u += 5) {
      const int d = 4 + u / 5 + v / 10;
      points.push_back({static_cast<std::int16_t>(u), static_cast<std::int16_t>(v),
                        static_cast<std::int16_t>(d), 0});
    }
  }
  return points;
}

TEST(Mesh, DoesNotDependOnTheOrderOfPoints) {
  auto points = plane_points(90, 70);
  const Mesh mesh = make_mesh(points, false);
  std::mt19937 random(3);
  for (int i = 0; i < 5; ++i) {
    std::shuffle(points.begin(), points.end(), random);
    const Mesh other = make_mesh(points, false);
    EXPECT_EQ(mesh.corners, other.corners);
    EXPECT_EQ(mesh.planes, other.planes);
  }
}

TEST(Mesh, PlanesPassThroughTheirCorners) {
  const auto points = plane_points(90, 70);
  for (const bool right : {false, true}) {
    const Mesh mesh = make_mesh(points, right);
    ASSERT_GT(mesh.triangles, 100);
    int usable = 0;
    for (int t = 0; t < mesh.triangles; ++t) {
      const std::int16_t* c = &mesh.corners[static_cast<std::size_t>(t * kCornerEntries)];
      const std::int32_t* plane = &mesh.planes[static_cast<std::size_t>(t * kPlaneEntries)];
      if (plane[3] == 0) continue;
      ++usable;
      EXPECT_EQ(plane_at(plane, 0, 0), plane[2] * 16);
      for (const int k : {2, 4}) {
        const int u = c[k];
        const int v = c[k + 1];
        const auto at = std::find_if(points.begin(), points.end(), [&](const SupportPoint& p) {
          return p.v == v && p.u - (right ? p.d : 0) == u;
        });
        ASSERT_NE(at, points.end());
        EXPECT_EQ(plane_at(plane, u - c[0], v - c[1]), at->d * 16);
      }
    }
    EXPECT_GT(usable, mesh.triangles / 2);
  }
}

TEST(Mesh, EveryPixelOfTheHullHasOneTriangle) {
  const Size size{100, 80};
  const Mesh mesh = make_mesh(plane_points(size.width, size.height), false);
  std::vector<int> hits(area(size), 0);
  for (int t = 0; t < mesh.triangles; ++t) {
    std::vector<std::int16_t> map(area(size));
    golden_plane_prior(
        size, std::span(mesh.corners).subspan(static_cast<std::size_t>(t * kCornerEntries)),
        std::span(mesh.planes).subspan(static_cast<std::size_t>(t * kPlaneEntries)), 1, map);
    for (std::size_t i = 0; i < map.size(); ++i) hits[i] += map[i] != kNoPlane;
  }
  for (int y = 5; y < 75; ++y) {
    for (int x = 5; x < 95; ++x) {
      EXPECT_EQ(hits[static_cast<std::size_t>(y * size.width + x)], 1) << x << "," << y;
    }
  }
}

TEST(Prior, EnergiesRiseFromThePlane) {
  const auto table = prior_energies(0.02, 3, 1, 2);
  EXPECT_EQ(table[0], 0);
  EXPECT_TRUE(std::is_sorted(table.begin(), table.end()));
  // -log(3) + log(4) over β, in sixteenths: 230.15
  EXPECT_EQ(table.back(), 230);
  // One pixel off with σ = 1: (log 4 - log(3 + exp(-1/2))) / 0.02 * 16 = 82.76
  EXPECT_EQ(table[16], 83);
}

}  // namespace
}  // namespace partita::depth
