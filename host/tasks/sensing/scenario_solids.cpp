#include "host/tasks/sensing/scenario_solids.h"

#include <algorithm>
#include <array>

namespace partita::sensing::scenario {

namespace {

// A ray of the sun runs this far along x and z for each metre it falls.
constexpr double kSunX = -0.55;
constexpr double kSunZ = 0.35;

Vec3 normal_of(std::span<const Vec3> polygon) {
  return cross(polygon[1] - polygon[0], polygon[2] - polygon[0]);
}

struct Point {
  double x;
  double z;
};

double turn(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x);
}

/// Andrew's monotone chain.
std::vector<Point> convex_hull(std::vector<Point> points) {
  std::sort(points.begin(), points.end(),
            [](Point a, Point b) { return a.x < b.x || (a.x == b.x && a.z < b.z); });
  std::vector<Point> hull;
  const auto extend = [&hull](Point p, std::size_t floor) {
    while (hull.size() > floor + 1 && turn(hull[hull.size() - 2], hull.back(), p) <= 0) {
      hull.pop_back();
    }
    hull.push_back(p);
  };
  for (const Point p : points) extend(p, 0);
  const std::size_t lower = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) extend(points[i], lower);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

}  // namespace

float light_on(Vec3 normal) {
  const Vec3 to_sun = unit(Vec3{-kSunX, -1.0, -kSunZ});
  const double direct = std::max(0.0, dot(normal, to_sun));
  return static_cast<float>(0.7 + 0.3 * direct / -to_sun.y);
}

void Builder::face(std::span<const Vec3> polygon, Vec3 inside, const Paint& paint, Vec3 origin,
                   Vec3 u_direction, Vec3 v_direction) {
  Vec3 normal = normal_of(polygon);
  const double size = length(normal);
  if (size < 1e-9) return;
  normal = normal * (1.0 / size);
  if (dot(normal, polygon[0] - inside) < 0) normal = normal * -1.0;
  const double scale = paint.texture->texels_per_metre();
  Face f;
  f.first = static_cast<std::uint32_t>(scene_.vertices.size());
  f.count = static_cast<std::uint32_t>(polygon.size());
  f.normal = normal;
  f.object = object_;
  f.surface = {paint.texture, origin,   u_direction * scale,          v_direction * scale,
               paint.u0,      paint.v0, paint.gain * light_on(normal)};
  scene_.vertices.insert(scene_.vertices.end(), polygon.begin(), polygon.end());
  scene_.solids.push_back(f);
}

void Builder::face(std::span<const Vec3> polygon, Vec3 inside, const Paint& paint) {
  const Vec3 along = polygon[1] - polygon[0];
  const Vec3 across = cross(normal_of(polygon), along);
  if (length(along) < 1e-9 || length(across) < 1e-12) return;
  face(polygon, inside, paint, polygon[0], unit(along), unit(across));
}

void Builder::box(const Place& place, const Extent& bottom, const Extent& top, double low,
                  double high, const Paint& sides, const Paint& ends, const Paint& roof) {
  const auto corner = [&](bool upper, bool right, bool front) {
    const Extent& e = upper ? top : bottom;
    return place.at(right ? e.r1 : e.r0, upper ? high : low, front ? e.f1 : e.f0);
  };
  const double middle_r = 0.5 * (bottom.r0 + bottom.r1);
  const double middle_f = 0.5 * (bottom.f0 + bottom.f1);
  const Vec3 inside = place.at(middle_r, 0.5 * (low + high), middle_f);
  const Vec3 origin = place.at(middle_r, low, middle_f);
  for (const bool right : {false, true}) {
    const std::array<Vec3, 4> side = {corner(false, right, false), corner(false, right, true),
                                      corner(true, right, true), corner(true, right, false)};
    face(side, inside, sides, origin, place.forward, place.up);
  }
  for (const bool front : {false, true}) {
    const std::array<Vec3, 4> end = {corner(false, false, front), corner(false, true, front),
                                     corner(true, true, front), corner(true, false, front)};
    face(end, inside, ends, origin, place.right, place.up);
  }
  const std::array<Vec3, 4> lid = {corner(true, false, false), corner(true, false, true),
                                   corner(true, true, true), corner(true, true, false)};
  face(lid, inside, roof, origin, place.forward, place.right);
}

void Builder::beam(Vec3 a, Vec3 b, double thickness, const Paint& paint) {
  const Vec3 along = unit(b - a);
  const Vec3 any = std::abs(along.y) < 0.8 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const Vec3 side = unit(cross(along, any)) * (0.5 * thickness);
  const Vec3 other = cross(along, side);
  const Vec3 inside = (a + b) * 0.5;
  const std::array<Vec3, 4> ring = {side + other, side - other, side * -1.0 - other, other - side};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 p = ring[i];
    const Vec3 q = ring[(i + 1) % 4];
    const std::array<Vec3, 4> quad = {a + p, b + p, b + q, a + q};
    face(quad, inside, paint);
  }
  for (const Vec3 end : {a, b}) {
    const std::array<Vec3, 4> cap = {end + ring[0], end + ring[1], end + ring[2], end + ring[3]};
    face(cap, inside, paint);
  }
}

void Builder::ellipsoid(const Place& centre, double r, double u, double f, const Paint& paint) {
  constexpr double kDiagonal = 0.70710678118654752440;
  constexpr std::array<Point, 8> kAround = {{{1, 0},
                                             {kDiagonal, kDiagonal},
                                             {0, 1},
                                             {-kDiagonal, kDiagonal},
                                             {-1, 0},
                                             {-kDiagonal, -kDiagonal},
                                             {0, -1},
                                             {kDiagonal, -kDiagonal}}};
  // Radius and height of the rings: sine and cosine of multiples of 36 degrees.
  constexpr std::array<Point, 6> kRings = {{{0, -1},
                                            {0.58778525229247313, -0.80901699437494742},
                                            {0.95105651629515357, -0.30901699437494742},
                                            {0.95105651629515357, 0.30901699437494742},
                                            {0.58778525229247313, 0.80901699437494742},
                                            {0, 1}}};
  const auto vertex = [&](std::size_t ring, std::size_t spoke) {
    const Point p = kAround[spoke % 8];
    const Point h = kRings[ring];
    return centre.at(r * h.x * p.x, u * h.z, f * h.x * p.z);
  };
  for (std::size_t ring = 0; ring + 1 < kRings.size(); ++ring) {
    for (std::size_t spoke = 0; spoke < 8; ++spoke) {
      std::array<Vec3, 4> quad = {vertex(ring, spoke), vertex(ring, spoke + 1),
                                  vertex(ring + 1, spoke + 1), vertex(ring + 1, spoke)};
      Paint own = paint;
      own.u0 += static_cast<double>(37 * spoke);
      own.v0 += static_cast<double>(53 * ring);
      if (ring == 0) quad = {quad[2], quad[3], quad[0], quad[0]};
      const std::size_t corners = ring == 0 || ring + 2 == kRings.size() ? 3 : 4;
      face(std::span<const Vec3>(quad.data(), corners), centre.origin, own);
    }
  }
}

void cast_shadow(Scene& scene, std::size_t first_solid) {
  for (const double ground : {0.0, -kPavementHeight}) {
    std::vector<Point> points;
    for (std::size_t i = first_solid; i < scene.solids.size(); ++i) {
      for (const Vec3& p : scene.polygon(scene.solids[i])) {
        const double height = std::max(0.0, ground - p.y);
        points.push_back({p.x + kSunX * height, p.z + kSunZ * height});
      }
    }
    if (points.size() < 3) return;
    const std::vector<Point> hull = convex_hull(std::move(points));
    Face f;
    f.first = static_cast<std::uint32_t>(scene.vertices.size());
    f.count = static_cast<std::uint32_t>(hull.size());
    f.normal = {0, -1, 0};
    for (const Point p : hull) scene.vertices.push_back({p.x, ground, p.z});
    if (hull.size() >= 3) scene.shadows.push_back(f);
  }
}

}  // namespace partita::sensing::scenario
