// Made-up inputs: for checking the kernels, for warming them up, and for tests that need the truth.
#ifndef PARTITA_HOST_TASKS_DEPTH_SYNTHETIC_H
#define PARTITA_HOST_TASKS_DEPTH_SYNTHETIC_H

#include <cstdint>
#include <vector>

#include "host/tasks/depth/golden.h"
#include "host/tasks/depth/planes.h"
#include "host/tasks/sensing/frame.h"

namespace partita::depth {

/// A textured plane: disparity a·x + b·y + c at pixel (x, y) of the left view; 0 <= a < 1.
struct SyntheticPlane {
  double a = 0;
  double b = 0;
  double c = 8;
  double at(int x, int y) const { return a * x + b * y + c; }
};

struct SyntheticPair {
  sensing::GrayImage left;
  sensing::GrayImage right;
};
SyntheticPair synthetic_pair(Size size, const SyntheticPlane& plane, std::uint32_t seed);

/// Descriptors of a picture, by the golden references.
std::vector<std::uint8_t> describe(const sensing::GrayImage& image);

/// A support grid, about `percent` of it filled with disparities near a plane, and some far off.
std::vector<std::int16_t> synthetic_grid(Size size, int step, int max_disparity, int percent,
                                         std::uint32_t seed);

/// The points of a grid as support_list lists them.
std::vector<SupportPoint> points_of(Size grid, int step, const std::vector<std::int16_t>& values);

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_SYNTHETIC_H
