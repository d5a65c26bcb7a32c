// Boxes in pictures: [x, x + width) x [y, y + height), px.
#ifndef PARTITA_HOST_TASKS_TRACKING_BOX_H
#define PARTITA_HOST_TASKS_TRACKING_BOX_H

#include <algorithm>

namespace partita::tracking {

struct Box {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;

  double area() const { return width * height; }
  double centre_x() const { return x + width / 2; }
  double centre_y() const { return y + height / 2; }
  bool operator==(const Box&) const = default;
};

inline Box box_around(double centre_x, double centre_y, double width, double height) {
  return {centre_x - width / 2, centre_y - height / 2, width, height};
}

inline double common_area(const Box& a, const Box& b) {
  const double width = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const double height = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  return std::max(width, 0.0) * std::max(height, 0.0);
}

/// Intersection over union, 0 for boxes without area.
inline double overlap(const Box& a, const Box& b) {
  const double common = common_area(a, b);
  return common > 0 ? common / (a.area() + b.area() - common) : 0.0;
}

/// Share of the box that a picture of that size holds.
inline double visible_share(const Box& box, int width, int height) {
  const Box picture{0, 0, static_cast<double>(width), static_cast<double>(height)};
  return box.area() > 0 ? common_area(box, picture) / box.area() : 0.0;
}

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_BOX_H
