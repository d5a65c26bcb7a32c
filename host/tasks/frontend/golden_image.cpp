#include <algorithm>
#include <array>

#include "host/tasks/frontend/golden.h"

namespace partita::frontend::golden {
namespace {

/// Position (12 x + 1) / 10 of an output pixel in the source: pixel and weight in 1/32.
std::pair<int, int> source_of(int x) {
  const int tenths = 12 * x + 1;
  return {tenths / 10, ((tenths % 10) * 32 + 5) / 10};
}

constexpr std::array<std::pair<int, int>, 16> kCircle{{{0, -3},
                                                       {1, -3},
                                                       {2, -2},
                                                       {3, -1},
                                                       {3, 0},
                                                       {3, 1},
                                                       {2, 2},
                                                       {1, 3},
                                                       {0, 3},
                                                       {-1, 3},
                                                       {-2, 2},
                                                       {-3, 1},
                                                       {-3, 0},
                                                       {-3, -1},
                                                       {-2, -2},
                                                       {-1, -3}}};

constexpr std::array kGaussian{18, 33, 49, 56, 49, 33, 18};

}  // namespace

GrayImage pyramid_down(const GrayImage& image) {
  const Size size = level_size({image.width, image.height}, 1);
  GrayImage out(size.width, size.height);
  for (int y = 0; y < size.height; ++y) {
    const auto [sy, wy] = source_of(y);
    for (int x = 0; x < size.width; ++x) {
      const auto [sx, wx] = source_of(x);
      const int sum = image.at(sx, sy) * (32 - wx) * (32 - wy) +
                      image.at(sx + 1, sy) * wx * (32 - wy) +
                      image.at(sx, sy + 1) * (32 - wx) * wy + image.at(sx + 1, sy + 1) * wx * wy;
      out.at(x, y) = static_cast<std::uint8_t>((sum + 512) / 1024);
    }
  }
  return out;
}

int fast_score_at(const GrayImage& image, int x, int y) {
  int best = 0;
  for (int sign = -1; sign <= 1; sign += 2) {
    for (std::size_t start = 0; start < 16; ++start) {
      int least = 255;
      for (std::size_t i = 0; i < 9; ++i) {
        const auto [dx, dy] = kCircle[(start + i) % 16];
        least = std::min(least, sign * (image.at(x + dx, y + dy) - image.at(x, y)));
      }
      best = std::max(best, least);
    }
  }
  return best;
}

GrayImage fast_score(const GrayImage& image, int threshold) {
  GrayImage out(image.width, image.height);
  for (int y = 3; y < image.height - 3; ++y) {
    for (int x = 3; x < image.width - 3; ++x) {
      const int score = fast_score_at(image, x, y);
      if (score > threshold) out.at(x, y) = static_cast<std::uint8_t>(score);
    }
  }
  return out;
}

GrayImage gaussian_blur(const GrayImage& image) {
  GrayImage columns(image.width, image.height);
  GrayImage out(image.width, image.height);
  for (int pass = 0; pass < 2; ++pass) {
    const GrayImage& from = pass == 0 ? image : columns;
    GrayImage& to = pass == 0 ? columns : out;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        int sum = 0;
        for (int i = -3; i <= 3; ++i) {
          const int sx = std::clamp(pass == 1 ? x + i : x, 0, image.width - 1);
          const int sy = std::clamp(pass == 0 ? y + i : y, 0, image.height - 1);
          sum += kGaussian[static_cast<std::size_t>(i + 3)] * from.at(sx, sy);
        }
        to.at(x, y) = static_cast<std::uint8_t>((sum + 128) / 256);
      }
    }
  }
  return out;
}

}  // namespace partita::frontend::golden
