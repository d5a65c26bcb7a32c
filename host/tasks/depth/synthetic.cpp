#include "host/tasks/depth/synthetic.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

#include "host/tasks/depth/geometry.h"

namespace partita::depth {
namespace {

/// A number in 0..255 for a lattice point.
double noise(std::uint32_t seed, int i, int j) {
  std::uint32_t h = seed * 0x9e3779b9u + static_cast<std::uint32_t>(i) * 0x85ebca6bu +
                    static_cast<std::uint32_t>(j) * 0xc2b2ae35u;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return static_cast<double>((h ^ (h >> 15)) & 255u);
}

/// Texture of the plane: noise on a lattice of 2.5 px, linear in between.
std::uint8_t texture(std::uint32_t seed, double x, int y) {
  const double column = x / 2.5;
  const int i = static_cast<int>(std::floor(column));
  const double share = column - i;
  const double value = noise(seed, i, y / 2) * (1 - share) + noise(seed, i + 1, y / 2) * share;
  return static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
}

}  // namespace

SyntheticPair synthetic_pair(Size size, const SyntheticPlane& plane, std::uint32_t seed) {
  SyntheticPair pair{{size.width, size.height}, {size.width, size.height}};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      pair.left.at(x, y) = texture(seed, x, y);
      // The left column whose disparity leads here: x_left - d(x_left, y) = x.
      const double x_left = (x + plane.b * y + plane.c) / (1 - plane.a);
      pair.right.at(x, y) = texture(seed, x_left, y);
    }
  }
  return pair;
}

std::vector<std::uint8_t> describe(const sensing::GrayImage& image) {
  const Size size{image.width, image.height};
  std::vector<std::uint8_t> du(area(size));
  std::vector<std::uint8_t> dv(area(size));
  std::vector<std::uint8_t> descriptors(area(size) * kDescriptorBytes);
  golden_sobel(size, image.pixels, du, dv);
  golden_descriptor(size, du, dv, descriptors);
  return descriptors;
}

std::vector<std::int16_t> synthetic_grid(Size size, int step, int max_disparity, int percent,
                                         std::uint32_t seed) {
  const Size grid = grid_size(size, step);
  std::vector<std::int16_t> values(area(grid), -1);
  std::mt19937 random(seed);
  std::size_t k = 0;
  for (int j = 0; j < grid.height; ++j) {
    for (int i = 0; i < grid.width; ++i, ++k) {
      if (static_cast<int>(random() % 100) >= percent) continue;
      const int near = (i + 2 * j) / 4 % (max_disparity + 1);
      const int far = static_cast<int>(random() % static_cast<unsigned>(max_disparity + 1));
      const int d = random() % 8 == 0 ? far : near;
      values[k] = static_cast<std::int16_t>(std::min(d, i * step));
    }
  }
  return values;
}

std::vector<SupportPoint> points_of(Size grid, int step, const std::vector<std::int16_t>& values) {
  std::vector<SupportPoint> points;
  for (int j = 0; j < grid.height; ++j) {
    for (int i = 0; i < grid.width; ++i) {
      const std::int16_t d = values[static_cast<std::size_t>(j * grid.width + i)];
      if (d < 0) continue;
      points.push_back(
          {static_cast<std::int16_t>(i * step), static_cast<std::int16_t>(j * step), d, 0});
    }
  }
  return points;
}

}  // namespace partita::depth
