#include <algorithm>
#include <cstddef>

#include "host/tasks/depth/golden.h"

namespace partita::depth {
namespace {

struct Offset {
  int x;
  int y;
};

// The gradient along x carries the disparity: it is sampled at the eight neighbours and at four
// pixels two rows away. Narrow windows keep to one side of an edge in depth. Of the gradient along
// y the four nearest are taken.
constexpr Offset kDuSamples[] = {{-1, -2}, {1, -2}, {-1, -1}, {0, -1}, {1, -1}, {-1, 0},
                                 {1, 0},   {-1, 1}, {0, 1},   {1, 1},  {-1, 2}, {1, 2}};
constexpr Offset kDvSamples[] = {{0, -1}, {-1, 0}, {1, 0}, {0, 1}};

std::uint8_t at(Size size, std::span<const std::uint8_t> image, int x, int y) {
  const int cx = std::clamp(x, 0, size.width - 1);
  const int cy = std::clamp(y, 0, size.height - 1);
  return image[static_cast<std::size_t>(cy) * static_cast<std::size_t>(size.width) +
               static_cast<std::size_t>(cx)];
}

std::uint8_t squeeze(int response) {
  return static_cast<std::uint8_t>(std::clamp(128 + (response >> 2), 0, 255));
}

}  // namespace

void golden_sobel(Size size, std::span<const std::uint8_t> image, std::span<std::uint8_t> du,
                  std::span<std::uint8_t> dv) {
  std::size_t i = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x, ++i) {
      const auto p = [&](int dx, int dy) { return int{at(size, image, x + dx, y + dy)}; };
      du[i] = squeeze(p(1, -1) + 2 * p(1, 0) + p(1, 1) - p(-1, -1) - 2 * p(-1, 0) - p(-1, 1));
      dv[i] = squeeze(p(-1, 1) + 2 * p(0, 1) + p(1, 1) - p(-1, -1) - 2 * p(0, -1) - p(1, -1));
    }
  }
}

void golden_descriptor(Size size, std::span<const std::uint8_t> du,
                       std::span<const std::uint8_t> dv, std::span<std::uint8_t> descriptors) {
  std::size_t i = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      for (const Offset o : kDuSamples) descriptors[i++] = at(size, du, x + o.x, y + o.y);
      for (const Offset o : kDvSamples) descriptors[i++] = at(size, dv, x + o.x, y + o.y);
    }
  }
}

}  // namespace partita::depth
