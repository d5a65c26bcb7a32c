#include "host/app/plot.h"

#include <cmath>
#include <numbers>

#include "host/io/file.h"

namespace partita::app::plot {

Rgb lighter(Rgb colour, double share) {
  const auto mix = [share](std::uint8_t c) {
    return static_cast<std::uint8_t>(std::lround(c + share * (255 - c)));
  };
  return {mix(colour.r), mix(colour.g), mix(colour.b)};
}

Rgb series(std::size_t number) {
  constexpr std::array<Rgb, 8> kColours{{{0, 114, 178},
                                         {230, 159, 0},
                                         {0, 158, 115},
                                         {204, 121, 167},
                                         {86, 180, 233},
                                         {213, 94, 0},
                                         {240, 228, 66},
                                         {0, 0, 0}}};
  return number < kColours.size() ? kColours[number] : kGrey;
}

double text_width(const std::string& text, double size) {
  constexpr double kMean = 0.56;  // of a sans-serif font's letters, in units of its size
  return kMean * size * static_cast<double>(text.size());
}

std::array<Point, 10> star(Point at, double radius) {
  std::array<Point, 10> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double angle = std::numbers::pi * (static_cast<double>(i) / 5 - 0.5);
    const double r = i % 2 == 0 ? radius : 0.45 * radius;
    corners[i] = {at.x + r * std::cos(angle), at.y + r * std::sin(angle)};
  }
  return corners;
}

void Drawing::write(const std::string& folder, const std::string& name) const {
  io::write_file(folder + "/" + name + ".svg", to_svg());
  io::write_file(folder + "/" + name + ".png", to_png());
}

}  // namespace partita::app::plot
