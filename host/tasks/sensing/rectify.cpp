#include "host/tasks/sensing/rectify.h"

#include <cmath>

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::sensing {

Eigen::Vector2d RawCamera::project(const Eigen::Vector3d& ray) const {
  const double x = ray.x() / ray.z(), y = ray.y() / ray.z();
  const auto& [k1, k2, p1, p2, k3] = distortion;
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + cx,
          fy * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + cy};
}

RectifyMap::RectifyMap(const RawCamera& raw, const Eigen::Matrix3d& R_rect_raw,
                       const StereoCalibration& c)
    : raw_width_(raw.width), raw_height_(raw.height), width_(c.width), height_(c.height) {
  sources_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  const Eigen::Matrix3d to_raw = R_rect_raw.transpose();
  for (int v = 0; v < height_; ++v) {
    for (int u = 0; u < width_; ++u) {
      const Eigen::Vector3d ray = to_raw * Eigen::Vector3d((u - c.cx) / c.fx, (v - c.cy) / c.fy, 1);
      if (!(ray.z() > 0.05)) continue;
      const Eigen::Vector2d p = raw.project(ray);
      if (!(p.x() >= 0 && p.y() >= 0 && p.x() < raw_width_ - 1 && p.y() < raw_height_ - 1))
        continue;
      const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
      Source& s = sources_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
                           static_cast<std::size_t>(u)];
      s.at = y * raw_width_ + x;
      s.x = static_cast<std::uint16_t>(std::lround((p.x() - x) * 256));
      s.y = static_cast<std::uint16_t>(std::lround((p.y() - y) * 256));
    }
  }
}

GrayImage RectifyMap::apply(const GrayImage& raw) const {
  if (raw.width != raw_width_ || raw.height != raw_height_) {
    throw Error(fmt::format("picture is {}x{}, expected {}x{} as the camera was calibrated",
                            raw.width, raw.height, raw_width_, raw_height_));
  }
  GrayImage out(width_, height_);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& s = sources_[i];
    if (s.at < 0) continue;
    const std::uint8_t* p = raw.pixels.data() + s.at;
    const int top = p[0] * (256 - s.x) + p[1] * s.x;
    const int bottom = p[raw_width_] * (256 - s.x) + p[raw_width_ + 1] * s.x;
    out.pixels[i] = static_cast<std::uint8_t>((top * (256 - s.y) + bottom * s.y + 32768) >> 16);
  }
  return out;
}

Rectification rectify(const RawCamera& left, const RawCamera& right, const Pose& T_left_right) {
  Rectification result;
  const Eigen::Vector3d x = T_left_right.translation().normalized();
  const Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ() + T_left_right.linear().col(2);
  const Eigen::Vector3d y = ahead.cross(x).normalized();
  result.R_rect_left << x.transpose(), y.transpose(), x.cross(y).transpose();
  result.R_rect_right = result.R_rect_left * T_left_right.linear();
  StereoCalibration& c = result.calibration;
  c.width = left.width;
  c.height = left.height;
  c.fx = c.fy = (left.fx + left.fy + right.fx + right.fy) / 4;
  c.baseline = T_left_right.translation().norm();
  // Where the raw pictures' centres look, without distortion, as that is small there.
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const bool second : {false, true}) {
    const RawCamera& camera = second ? right : left;
    const Eigen::Vector3d ray((0.5 * (camera.width - 1) - camera.cx) / camera.fx,
                              (0.5 * (camera.height - 1) - camera.cy) / camera.fy, 1);
    const Eigen::Vector3d turned = (second ? result.R_rect_right : result.R_rect_left) * ray;
    centre += 0.5 * c.fx * turned.head<2>() / turned.z();
  }
  c.cx = 0.5 * (c.width - 1) - centre.x();
  c.cy = 0.5 * (c.height - 1) - centre.y();
  return result;
}

}  // namespace partita::sensing
