#include "host/tasks/sensing/scenario_raster.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace partita::sensing::scenario {

namespace {

constexpr double kNear = 0.15;
constexpr std::uint32_t kShadow = 0x80000000U;
constexpr float kShade = 0.55F;                 // of the light that is left in a shadow
constexpr float kHaze = 206.0F;                 // gray of the far distance
constexpr float kHazeRange2 = 160.0F * 160.0F;  // half of it at 160 m
constexpr double kBias = 65536.0;  // texels; a multiple of every tile, keeps coordinates positive
constexpr int kBlock = 16;         // pixels that share a texture level
constexpr int kFraction = 64;      // steps per gray level before the sensor rounds

/// value(x, y) = c + x * px + y * py over the picture.
struct Linear {
  double c = 0;
  double px = 0;
  double py = 0;
  double at(double x, double y) const { return c + py * y + px * x; }
};

/// a.ray + b as a function of the pixel, ray = ((x - cx)/fx, (y - cy)/fy, 1).
Linear along_ray(const StereoCalibration& camera, Vec3 a) {
  const double px = a.x / camera.fx;
  const double py = a.y / camera.fy;
  return {a.z - px * camera.cx - py * camera.cy, px, py};
}
Linear sum(Linear a, Linear b, double scale) {
  return {a.c + b.c * scale, a.px + b.px * scale, a.py + b.py * scale};
}

/// Finds which pixels a face covers: per row the half-open range between its edges. Pixels belong
/// to the face that contains their centre; faces that share an edge leave no gap and no overlap.
class Outline {
 public:
  struct Corner {
    double x;
    double y;
  };

  explicit Outline(const View& view)
      : view_(view), low_(static_cast<std::size_t>(view.camera.height)), high_(low_.size()) {}

  /// Calls row(y, x_begin, x_end) for every row with pixels.
  template <class Row>
  void visit(std::span<const Vec3> polygon, Row row) {
    if (!project(polygon)) return;
    double top = corners_[0].y;
    double bottom = top;
    for (std::size_t i = 0; i < count_; ++i) {
      top = std::min(top, corners_[i].y);
      bottom = std::max(bottom, corners_[i].y);
    }
    const int first = clamped(std::ceil(top), view_.camera.height);
    const int end = clamped(std::ceil(bottom), view_.camera.height);
    if (first >= end) return;
    std::fill(low_.begin() + first, low_.begin() + end, std::numeric_limits<double>::max());
    std::fill(high_.begin() + first, high_.begin() + end, std::numeric_limits<double>::lowest());
    for (std::size_t i = 0; i < count_; ++i) {
      trace(corners_[i], corners_[i + 1 == count_ ? 0 : i + 1]);
    }
    for (int y = first; y < end; ++y) {
      const int begin_x = clamped(std::ceil(low_[static_cast<std::size_t>(y)]), view_.camera.width);
      const int end_x = clamped(std::ceil(high_[static_cast<std::size_t>(y)]), view_.camera.width);
      if (begin_x < end_x) row(y, begin_x, end_x);
    }
  }

  /// Of the polygon visited last, as far as it lies before the camera, also outside of the picture.
  std::span<const Corner> corners() const { return {corners_.data(), count_}; }

 private:
  static constexpr std::size_t kMaxCorners = 64;

  static int clamped(double value, int limit) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
  }

  void push(Vec3 p) {
    if (count_ == kMaxCorners) return;
    const StereoCalibration& c = view_.camera;
    corners_[count_++] = {c.fx * (p.x / p.z) + c.cx, c.fy * (p.y / p.z) + c.cy};
  }

  /// To pixels, cut off at the near plane. False if nothing is before the camera.
  bool project(std::span<const Vec3> polygon) {
    count_ = 0;
    Vec3 previous = rotate_back(view_.R_world_cam, polygon.back() - view_.position);
    for (const Vec3& vertex : polygon) {
      const Vec3 current = rotate_back(view_.R_world_cam, vertex - view_.position);
      if ((previous.z >= kNear) != (current.z >= kNear)) {
        const double t = (kNear - previous.z) / (current.z - previous.z);
        Vec3 cut = previous + (current - previous) * t;
        cut.z = kNear;
        push(cut);
      }
      if (current.z >= kNear) push(current);
      previous = current;
    }
    return count_ >= 3;
  }

  void trace(Corner a, Corner b) {
    if (a.y > b.y) std::swap(a, b);  // the same arithmetic for both faces of an edge
    const int first = clamped(std::ceil(a.y), view_.camera.height);
    const int end = clamped(std::ceil(b.y), view_.camera.height);
    if (first >= end) return;
    const double slope = (b.x - a.x) / (b.y - a.y);
    for (int y = first; y < end; ++y) {
      const double x = a.x + (static_cast<double>(y) - a.y) * slope;
      const auto i = static_cast<std::size_t>(y);
      low_[i] = std::min(low_[i], x);
      high_[i] = std::max(high_[i], x);
    }
  }

  const View& view_;
  std::vector<double> low_;
  std::vector<double> high_;
  std::array<Corner, kMaxCorners> corners_{};
  std::size_t count_ = 0;
};

/// The face's plane as 1/z over the picture; false where it is seen from behind.
bool inverse_depth_of(const Scene& scene, const Face& face, const View& view, Linear& w) {
  const Vec3 to_face = scene.vertices[face.first] - view.position;
  const double d = dot(face.normal, to_face);
  if (d >= 0) return false;
  w = along_ray(view.camera, rotate_back(view.R_world_cam, face.normal) * (1.0 / d));
  return true;
}

struct Mapping {
  Linear w;  // 1/z
  Linear u;  // u/z, texels
  Linear v;
};

Mapping mapping_of(const Surface& s, const View& view, const Linear& w) {
  const Vec3 offset = view.position - s.origin;
  const auto one = [&](Vec3 axis, double start) {
    const Linear ray = along_ray(view.camera, rotate_back(view.R_world_cam, axis));
    return sum(ray, w, dot(axis, offset) + start + kBias);
  };
  return {w, one(s.u_axis, s.u0), one(s.v_axis, s.v0)};
}

/// The sky is a plane that moves along with the camera: clouds that have no parallax.
Mapping sky_mapping(const View& view) {
  const Rotation& R = view.R_world_cam;
  const Vec3 up{-R.x.y, -R.y.y, -R.z.y};  // of a world direction, as a function of the ray
  const Vec3 east{R.x.x, R.y.x, R.z.x};
  const Vec3 north{R.x.z, R.y.z, R.z.z};
  Linear w = along_ray(view.camera, up);
  w.c += 0.04;
  constexpr double kTexels = 90.0;
  return {w, sum(along_ray(view.camera, east * kTexels), w, kBias),
          sum(along_ray(view.camera, north * kTexels), w, kBias)};
}

/// The exponent of 2 nearest to a footprint of that many texels, from the bits of the float: exact.
int level_of(double texels, int largest) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(texels * 1.25));
  return std::clamp(static_cast<int>(bits >> 23) - 127, 0, largest);
}

/// Textures pixels [x, end) of one row, at most kBlock of them, into out.
void texture_block(const Mapping& m, const Texture& texture, float gain, float haze_scale, int y,
                   int x, int end, std::uint16_t* out) {
  const double row = y;
  const double middle = 0.5 * (x + end - 1);
  const double z_middle = 1.0 / m.w.at(middle, row);
  const double u_middle = m.u.at(middle, row) * z_middle;
  const double v_middle = m.v.at(middle, row) * z_middle;
  const auto footprint = [z_middle](const Linear& t, const Linear& w, double value) {
    return std::max(std::abs((t.px - value * w.px) * z_middle),
                    std::abs((t.py - value * w.py) * z_middle));
  };
  const int level_u = level_of(footprint(m.u, m.w, u_middle), texture.max_level_u());
  const int level_v = level_of(footprint(m.v, m.w, v_middle), texture.max_level_v());
  const Texture::Level& level = texture.level(level_u, level_v);
  const double scale_u = 256.0 / (1 << level_u);
  const double scale_v = 256.0 / (1 << level_v);

  const int count = end - x;
  std::array<std::int32_t, kBlock> us;
  std::array<std::int32_t, kBlock> vs;
  std::array<float, kBlock> haze;
  const double w0 = m.w.c + m.w.py * row;
  const double u0 = m.u.c + m.u.py * row;
  const double v0 = m.v.c + m.v.py * row;
  for (int i = 0; i < count; ++i) {
    const double at = x + i;
    const double z = 1.0 / (w0 + m.w.px * at);
    us[i] = static_cast<std::int32_t>((u0 + m.u.px * at) * z * scale_u) - 128;
    vs[i] = static_cast<std::int32_t>((v0 + m.v.px * at) * z * scale_v) - 128;
    const float distance = static_cast<float>(z) * haze_scale;
    haze[i] = kHazeRange2 / (kHazeRange2 + distance * distance);
  }
  for (int i = 0; i < count; ++i) {
    const std::int32_t fu = us[i] & 255;
    const std::int32_t fv = vs[i] & 255;
    const std::int32_t iu = us[i] >> 8;
    const std::int32_t iv = vs[i] >> 8;
    const std::uint8_t* upper = level.data + ((iv & level.mask_v) << level.shift);
    const std::uint8_t* lower = level.data + (((iv + 1) & level.mask_v) << level.shift);
    const std::int32_t a = iu & level.mask_u;
    const std::int32_t b = (iu + 1) & level.mask_u;
    const std::int32_t top = upper[a] * (256 - fu) + upper[b] * fu;
    const std::int32_t bottom = lower[a] * (256 - fu) + lower[b] * fu;
    us[i] = top * (256 - fv) + bottom * fv;
  }
  for (int i = 0; i < count; ++i) {
    const float lit = static_cast<float>(us[i]) * (gain / 65536.0F);
    const float seen = kHaze + (lit - kHaze) * haze[i];
    out[i] = static_cast<std::uint16_t>(std::min(std::max(seen, 0.0F), 255.0F) * kFraction);
  }
}

class Painter {
 public:
  Painter(const Scene& scene, const View& view)
      : scene_(scene), view_(view), width_(view.camera.width), height_(view.camera.height) {
    const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    picture_.inverse_depth.assign(pixels, 0.0F);
    picture_.faces.assign(pixels, 0);
  }

  Picture paint(std::uint64_t noise_seed) {
    Outline outline(view_);
    planes_.resize(scene_.ground.size() + scene_.solids.size());
    for (std::size_t i = 0; i < scene_.ground.size(); ++i) place(outline, scene_.ground[i], i);
    for (const Face& shadow : scene_.shadows) darken(outline, shadow);
    for (std::size_t i = 0; i < scene_.solids.size(); ++i) {
      place(outline, scene_.solids[i], scene_.ground.size() + i);
    }
    std::vector<std::uint16_t> light = texture_all();
    expose(light, noise_seed);
    return std::move(picture_);
  }

 private:
  std::size_t offset(int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
  }

  void place(Outline& outline, const Face& face, std::size_t index) {
    Linear& w = planes_[index];
    if (!inverse_depth_of(scene_, face, view_, w)) return;
    const auto id = static_cast<std::uint32_t>(index + 1);
    outline.visit(scene_.polygon(face), [&](int y, int begin, int end) {
      float* depth = picture_.inverse_depth.data() + offset(y);
      std::uint32_t* ids = picture_.faces.data() + offset(y);
      const auto first = static_cast<float>(w.at(begin, y));
      const auto step = static_cast<float>(w.px);
      for (int x = begin; x < end; ++x) {
        const float here = first + step * static_cast<float>(x - begin);
        const bool nearer = here > depth[x];
        depth[x] = nearer ? here : depth[x];
        ids[x] = nearer ? id : ids[x];
      }
    });
  }

  void darken(Outline& outline, const Face& shadow) {
    Linear w;
    if (!inverse_depth_of(scene_, shadow, view_, w)) return;
    outline.visit(scene_.polygon(shadow), [&](int y, int begin, int end) {
      const float* depth = picture_.inverse_depth.data() + offset(y);
      std::uint32_t* ids = picture_.faces.data() + offset(y);
      for (int x = begin; x < end; ++x) {
        const auto here = static_cast<float>(w.at(x, y));
        const float apart = here - depth[x];
        if (apart * apart < here * here * 1e-6F) ids[x] |= kShadow;
      }
    });
  }

  std::vector<std::uint16_t> texture_all() {
    std::vector<std::uint16_t> light(picture_.faces.size());
    const Mapping sky = sky_mapping(view_);
    std::uint32_t known = 0;
    Mapping mapping;
    for (int y = 0; y < height_; ++y) {
      std::uint32_t* ids = picture_.faces.data() + offset(y);
      std::uint16_t* out = light.data() + offset(y);
      for (int x = 0; x < width_;) {
        const std::uint32_t id = ids[x];
        int end = x + 1;
        const int limit = std::min(width_, (x / kBlock + 1) * kBlock);
        while (end < limit && ids[end] == id) ++end;
        if (id == 0) {
          texture_sky(sky, y, x, end, out + x);
        } else {
          const std::uint32_t index = (id & ~kShadow) - 1;
          const Surface& surface = face(index).surface;
          if (known != index + 1) mapping = mapping_of(surface, view_, planes_[index]);
          known = index + 1;
          const float gain = (id & kShadow) != 0 ? surface.gain * kShade : surface.gain;
          texture_block(mapping, *surface.texture, gain, 1.0F, y, x, end, out + x);
        }
        x = end;
      }
      for (int x = 0; x < width_; ++x) ids[x] &= ~kShadow;
    }
    return light;
  }

  /// At the horizon, where the plane of clouds runs out, there is only haze.
  void texture_sky(const Mapping& sky, int y, int x, int end, std::uint16_t* out) const {
    const double lowest = std::min(sky.w.at(x, y), sky.w.at(end - 1, y));
    if (lowest < 0.03) {
      std::fill(out, out + (end - x), static_cast<std::uint16_t>(kHaze * kFraction));
    } else {
      texture_block(sky, *scene_.sky, 1.0F, 16.0F, y, x, end, out);
    }
  }

  const Face& face(std::uint32_t index) const {
    const auto ground = static_cast<std::uint32_t>(scene_.ground.size());
    return index < ground ? scene_.ground[index] : scene_.solids[index - ground];
  }

  /// The lens's blur, the sensor's noise, and rounding to 8 bits.
  void expose(std::vector<std::uint16_t>& light, std::uint64_t noise_seed) {
    picture_.gray = GrayImage(width_, height_);
    std::vector<std::uint16_t> blurred(light.size());
    for (int y = 0; y < height_; ++y) {
      const std::uint16_t* in = light.data() + offset(y);
      std::uint16_t* out = blurred.data() + offset(y);
      for (int x = 1; x + 1 < width_; ++x) {
        out[x] = static_cast<std::uint16_t>((in[x - 1] + 6 * in[x] + in[x + 1]) >> 3);
      }
      out[0] = in[0];
      out[width_ - 1] = in[width_ - 1];
    }
    std::vector<std::uint64_t> random(static_cast<std::size_t>(width_) / 16 + 1);
    for (int y = 0; y < height_; ++y) {
      const std::uint64_t row_seed = hash(noise_seed, static_cast<std::uint64_t>(y));
      for (std::size_t i = 0; i < random.size(); ++i) random[i] = hash(row_seed, i);
      const std::uint16_t* above = blurred.data() + offset(std::max(0, y - 1));
      const std::uint16_t* in = blurred.data() + offset(y);
      const std::uint16_t* below = blurred.data() + offset(std::min(height_ - 1, y + 1));
      std::uint8_t* out = picture_.gray.row(y);
      for (int x = 0; x < width_; ++x) {
        const int value = (above[x] + 6 * in[x] + below[x]) >> 3;
        const auto bits =
            static_cast<int>(random[static_cast<std::size_t>(x) >> 4] >> ((x & 15) * 4));
        const int noise = ((bits & 3) + ((bits >> 2) & 3) - 3) * 48;  // triangular, +-2.25 levels
        const int level = (value + noise + kFraction / 2) / kFraction;
        out[x] = static_cast<std::uint8_t>(std::clamp(level, 0, 255));
      }
    }
  }

  const Scene& scene_;
  const View& view_;
  int width_;
  int height_;
  std::vector<Linear> planes_;
  Picture picture_;
};

}  // namespace

Picture draw(const Scene& scene, const View& view, std::uint64_t noise_seed) {
  return Painter(scene, view).paint(noise_seed);
}

namespace {

/// The smallest box that holds what was added.
struct Bounds {
  double left = std::numeric_limits<double>::max();
  double top = std::numeric_limits<double>::max();
  double right = std::numeric_limits<double>::lowest();
  double bottom = std::numeric_limits<double>::lowest();

  void add(double x, double y) {
    left = std::min(left, x);
    right = std::max(right, x);
    top = std::min(top, y);
    bottom = std::max(bottom, y);
  }
  double area() const { return (right - left) * (bottom - top); }
};

}  // namespace

std::vector<Silhouette> silhouettes(const Scene& scene, const View& view, const Picture& picture,
                                    std::size_t objects) {
  std::vector<Silhouette> result(objects);
  std::vector<Bounds> whole(objects);   // were the picture without edges
  std::vector<Bounds> inside(objects);  // were nothing before the object
  std::vector<std::int32_t> stamp(picture.faces.size(), -1);
  Outline outline(view);
  const int width = view.camera.width;
  for (const Face& face : scene.solids) {
    Linear w;
    if (face.object < 0 || !inverse_depth_of(scene, face, view, w)) continue;
    const auto object = static_cast<std::size_t>(face.object);
    outline.visit(scene.polygon(face), [&](int y, int begin, int end) {
      inside[object].add(begin, y);
      inside[object].add(end, y + 1);
      std::int32_t* row = stamp.data() + static_cast<std::size_t>(y) * width;
      for (int x = begin; x < end; ++x) {
        result[object].pixels += row[x] != face.object ? 1 : 0;
        row[x] = face.object;
      }
    });
    for (const Outline::Corner& c : outline.corners()) whole[object].add(c.x, c.y);
  }
  for (std::size_t i = 0; i < picture.faces.size(); ++i) {
    const std::uint32_t id = picture.faces[i];
    if (id <= scene.ground.size()) continue;
    const std::int32_t object = scene.solids[id - 1 - scene.ground.size()].object;
    if (object < 0) continue;
    const int x = static_cast<int>(i % static_cast<std::size_t>(width));
    const int y = static_cast<int>(i / static_cast<std::size_t>(width));
    Silhouette& s = result[static_cast<std::size_t>(object)];
    const bool first = s.visible++ == 0;
    s.left = first ? x : std::min(s.left, x);
    s.right = first ? x : std::max(s.right, x);
    s.top = first ? y : s.top;  // pixels come row by row
    s.bottom = y;
  }
  for (std::size_t i = 0; i < objects; ++i) {
    if (result[i].pixels == 0) continue;
    result[i].truncated = std::clamp(1.0 - inside[i].area() / whole[i].area(), 0.0, 1.0);
  }
  return result;
}

}  // namespace partita::sensing::scenario
