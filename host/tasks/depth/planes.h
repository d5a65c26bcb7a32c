// The slanted planes through the triangles' corners, μ(u, v) = a u + b v + c of the paper, in fixed
// point, and the prior's energies as a table of integers.
#ifndef PARTITA_HOST_TASKS_DEPTH_PLANES_H
#define PARTITA_HOST_TASKS_DEPTH_PLANES_H

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host/tasks/depth/delaunay.h"
#include "host/tasks/depth/golden.h"

namespace partita::depth {

/// Numbers of a triangle in `corners`: u, v of its corners in order of row and column, two zeros.
inline constexpr int kCornerEntries = 8;
/// Numbers of a triangle in `planes`: slopes along u and v (16 fractional bits), the disparity of
/// the first corner, and 1 if the plane is to be used.
inline constexpr int kPlaneEntries = 4;

/// Triangles as the device takes them.
struct Mesh {
  std::vector<std::int16_t> corners;
  std::vector<std::int32_t> planes;
  int triangles = 0;
  std::int64_t spans = 0;     ///< Σ of the triangles' heights: rows of pixels to fill
  std::int64_t covered = 0;   ///< the triangles' area, px
  std::int64_t overlaps = 0;  ///< Σ of the bands of kBand rows that each triangle touches
};

/// A support point: column and row of the left view, disparity.
struct SupportPoint {
  std::int16_t u;
  std::int16_t v;
  std::int16_t d;
  std::int16_t unused;
};
static_assert(sizeof(SupportPoint) == 8);

/// How many points add_corners() adds at most.
inline constexpr int kCornerPoints = 6;
/// The points with others at the left picture's corners and at the right picture's on the right
/// side, each with the disparity of the nearest point, so that the meshes cover both pictures.
/// Fewer than three points stay as they are: they say too little.
std::vector<SupportPoint> add_corners(std::span<const SupportPoint> points, Size size);

/// Triangulates the points of one view (in the right one a point sits at u - d) and computes the
/// planes. Of two points on the same pixel the first is kept. Empty if fewer than three points, or
/// all on one line.
Mesh make_mesh(std::span<const SupportPoint> points, bool right);

/// Slopes beyond this are of triangles that bridge two surfaces; their planes say nothing.
/// Along u a visible surface cannot reach a slope of one. With pictures up to kLargestSide no sum
/// in plane_at leaves 32 bits.
inline constexpr std::int32_t kSteepestU = 1 << 16;
inline constexpr std::int32_t kSteepestV = 4 << 16;

/// Disparity of the plane at (du, dv) from its first corner, 1/16 px.
inline std::int16_t plane_at(const std::int32_t* plane, int du, int dv) {
  if (plane[3] == 0) return kNoPlane;
  constexpr int kShift = 16 - kPlaneBits;
  const std::int32_t rise = plane[0] * du + plane[1] * dv;
  return static_cast<std::int16_t>(plane[2] * (1 << kPlaneBits) +
                                   ((rise + (1 << (kShift - 1))) >> kShift));
}

/// Energies of the prior, -log(γ + exp(-(d - μ)² / 2σ²)) / β, above their least value, in units of
/// 1/16 of the descriptors' distance: entry i for |d - μ| = i/16 px, the last for -log γ.
std::vector<std::uint16_t> prior_energies(double beta, double gamma, double sigma, int radius);

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_PLANES_H
