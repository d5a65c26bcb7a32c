// Draws textured planar faces: projection, depth buffer, perspective-correct texturing.
//
// For a face in a plane n.p = d (camera axes), 1/z is linear in the pixel's coordinates, and so are
// u/z and v/z of any affine texture coordinates. All three are evaluated at each pixel in double
// precision, so depth, disparity and texture of the two cameras agree to far below a pixel's
// hundredth. First every face is written into a depth buffer, then every pixel is textured once.
#ifndef PARTITA_HOST_TASKS_SENSING_SCENARIO_RASTER_H
#define PARTITA_HOST_TASKS_SENSING_SCENARIO_RASTER_H

#include <cstdint>
#include <span>
#include <vector>

#include "host/tasks/sensing/frame.h"
#include "host/tasks/sensing/scenario_math.h"
#include "host/tasks/sensing/scenario_textures.h"

namespace partita::sensing::scenario {

/// How a face looks. u = u0 + u_axis.(p - origin), v likewise, in texels; axes in texels per metre.
struct Surface {
  const Texture* texture = nullptr;
  Vec3 origin;
  Vec3 u_axis;
  Vec3 v_axis;
  double u0 = 0;
  double v0 = 0;
  float gain = 1;  ///< paint and light: multiplies the texture
};

/// A convex planar polygon. Seen from its front its vertices run clockwise on the screen; from
/// behind it is not drawn.
struct Face {
  std::uint32_t first = 0;  ///< of Scene::vertices
  std::uint32_t count = 0;
  Vec3 normal;  ///< towards the front; any length
  Surface surface;
  std::int32_t object = -1;  ///< index of the road user it belongs to
};

/// Everything there is at one moment, in world axes.
struct Scene {
  std::vector<Vec3> vertices;
  std::vector<Face> ground;   ///< drawn first; what shadows fall on
  std::vector<Face> shadows;  ///< coplanar with ground faces, which they darken; no surface
  std::vector<Face> solids;
  const Texture* sky = nullptr;

  std::span<const Vec3> polygon(const Face& f) const {
    return {vertices.data() + f.first, f.count};
  }
};

struct View {
  Vec3 position;
  Rotation R_world_cam;
  StereoCalibration camera;
};

/// What one camera sees.
struct Picture {
  GrayImage gray;
  std::vector<float> inverse_depth;  ///< 1/z per pixel, 0 for sky
  std::vector<std::uint32_t>
      faces;  ///< per pixel: 0 for sky, else 1 + index over ground and solids
};

/// Draws the scene. The lens blurs a little (1 6 1 along both axes), and the sensor adds noise of
/// about one gray level drawn from noise_seed.
Picture draw(const Scene& scene, const View& view, std::uint64_t noise_seed);

/// What of each object's projection the picture shows.
struct Silhouette {
  int left = 0;  ///< of the pixels that show the object
  int top = 0;
  int right = -1;  ///< inclusive; below left where no pixel shows it
  int bottom = -1;
  std::int64_t pixels = 0;   ///< that would show it if nothing were before it
  std::int64_t visible = 0;  ///< that show it
  double truncated = 0;  ///< share of the projection's bounding box outside of the picture, 0..1
};
std::vector<Silhouette> silhouettes(const Scene& scene, const View& view, const Picture& picture,
                                    std::size_t objects);

}  // namespace partita::sensing::scenario

#endif  // PARTITA_HOST_TASKS_SENSING_SCENARIO_RASTER_H
