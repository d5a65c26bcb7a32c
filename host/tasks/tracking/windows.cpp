#include "host/tasks/tracking/windows.h"

#include <algorithm>
#include <cmath>

namespace partita::tracking {
namespace {

constexpr double kSmallestSide = 3;  ///< px; a box does not shrink below

std::int32_t fixed(double value) {
  return static_cast<std::int32_t>(std::lround(value * 65536));
}

/// Where the parabola through three neighbouring values has its top, from the middle one.
double top_of_parabola(double before, double at, double after) {
  const double curvature = before - 2 * at + after;
  return curvature < 0 ? std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5) : 0.0;
}

}  // namespace

double scale_factor(const FilterParameters& parameters, int s) {
  return std::pow(parameters.scale_step, s - parameters.scales / 2);
}

double window_side(const FilterParameters& parameters, const Box& box, double factor) {
  return parameters.padding * std::sqrt(box.area()) * factor;
}

Window make_window(const FilterParameters& parameters, const Box& box, double factor) {
  const double side = window_side(parameters, box, factor);
  const double step = side / parameters.template_side;
  // Pixel (x, y) has its centre at (x + 1/2, y + 1/2), and so have samples.
  const double from_centre = (step - side) / 2 - 0.5;
  std::int32_t shift = 0;
  while (shift < 3 && step > 1.5 * (1 << shift)) ++shift;
  return {fixed(box.centre_x() + from_centre), fixed(box.centre_y() + from_centre), fixed(step),
          fixed(step), shift};
}

Located interpret_peaks(const FilterParameters& parameters, const Box& box,
                        std::span<const float> peaks, Picture size) {
  const auto middle = static_cast<std::size_t>(parameters.scales / 2);
  std::size_t best = middle;
  const auto value = [&](std::size_t s) {
    return peaks[s * kPeakEntries] * (s == middle ? 1.0 : parameters.scale_penalty);
  };
  for (std::size_t s = 0; s < static_cast<std::size_t>(parameters.scales); ++s) {
    if (value(s) > value(best)) best = s;
  }
  const float* peak = &peaks[best * kPeakEntries];
  const int cells = parameters.template_side / kCell;
  const auto place = static_cast<int>(peak[1]);
  // Shifts are cyclic: those of more than half the plane are negative ones.
  const auto shift = [cells](int cell) { return cell < cells / 2 ? cell : cell - cells; };
  const double dx = shift(place % cells) + top_of_parabola(peak[2], peak[0], peak[3]);
  const double dy = shift(place / cells) + top_of_parabola(peak[4], peak[0], peak[5]);
  const double factor = scale_factor(parameters, static_cast<int>(best));
  const double per_cell = window_side(parameters, box, factor) / cells;
  double width = box.width * factor;
  double height = box.height * factor;
  const bool possible =
      std::min(width, height) >= kSmallestSide && width <= size.width && height <= size.height;
  if (!possible) {
    width = box.width;
    height = box.height;
  }
  return {box_around(box.centre_x() + dx * per_cell, box.centre_y() + dy * per_cell, width, height),
          peak[0]};
}

}  // namespace partita::tracking
