// Solids made of textured faces, placed in a scene.
#ifndef PARTITA_HOST_TASKS_SENSING_SCENARIO_SOLIDS_H
#define PARTITA_HOST_TASKS_SENSING_SCENARIO_SOLIDS_H

#include <cstdint>
#include <span>
#include <vector>

#include "host/tasks/sensing/scenario_raster.h"

namespace partita::sensing::scenario {

/// A place with a heading on the ground: local coordinates are right, up, forward, in metres.
struct Place {
  Vec3 origin;
  Vec3 right{1, 0, 0};
  Vec3 up{0, -1, 0};
  Vec3 forward{0, 0, 1};

  Vec3 at(double r, double u, double f) const { return origin + right * r + up * u + forward * f; }
  /// The same axes elsewhere.
  Place moved(double r, double u, double f) const { return {at(r, u, f), right, up, forward}; }
};

struct Paint {
  const Texture* texture = nullptr;
  float gain = 1;
  double u0 = 0;  ///< texels; sets instances of one texture apart
  double v0 = 0;
};

/// Adds solids to a scene, lit by the sun, all on behalf of one object (or none: -1).
class Builder {
 public:
  Builder(Scene& scene, std::int32_t object) : scene_(scene), object_(object) {}

  /// A planar convex polygon; its front is the side that faces away from `inside`. Texture: u along
  /// u_direction, v along v_direction (unit vectors), from origin.
  void face(std::span<const Vec3> polygon, Vec3 inside, const Paint& paint, Vec3 origin,
            Vec3 u_direction, Vec3 v_direction);
  /// The same with texture axes along the polygon's first edge and across it.
  void face(std::span<const Vec3> polygon, Vec3 inside, const Paint& paint);

  /// A box over [r0,r1] x [u0,u1] x [f0,f1] of a place, without its bottom. Its top narrows to
  /// [rt0,rt1] x [ft0,ft1]. Texture origins lie in the middle of the bottom edges.
  struct Extent {
    double r0, r1, f0, f1;
  };
  void box(const Place& place, const Extent& bottom, const Extent& top, double low, double high,
           const Paint& sides, const Paint& ends, const Paint& roof);

  /// A four-sided bar from a to b.
  void beam(Vec3 a, Vec3 b, double thickness, const Paint& paint);

  /// An ellipsoid of eight by five facets around a centre, in a place's axes.
  void ellipsoid(const Place& centre, double r, double u, double f, const Paint& paint);

 private:
  Scene& scene_;
  std::int32_t object_;
};

/// Adds to scene.shadows what the solids from `first_solid` on cast onto the ground planes y = 0
/// and y = -kPavementHeight: the convex hull of their vertices along the sun's rays.
void cast_shadow(Scene& scene, std::size_t first_solid);

inline constexpr double kPavementHeight = 0.12;

/// The light that a surface with this unit normal gets, 1 being the ground's.
float light_on(Vec3 normal);

}  // namespace partita::sensing::scenario

#endif  // PARTITA_HOST_TASKS_SENSING_SCENARIO_SOLIDS_H
