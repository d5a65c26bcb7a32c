#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "host/tasks/tracking/golden.h"
#include "host/tasks/tracking/golden_math.h"

namespace partita::tracking {
namespace {

/// A bilinear sample with kPatchBits fractional bits; x and y in 16.16, of which 8 bits count.
int sample(Picture size, std::span<const std::uint8_t> image, int x, int y) {
  const int x0 = std::clamp(x >> 16, 0, size.width - 1);
  const int x1 = std::clamp((x >> 16) + 1, 0, size.width - 1);
  const int y0 = std::clamp(y >> 16, 0, size.height - 1);
  const int y1 = std::clamp((y >> 16) + 1, 0, size.height - 1);
  const int fx = (x >> 8) & 255;
  const int fy = (y >> 8) & 255;
  const auto pixel = [&](int px, int py) -> int {
    return image[static_cast<std::size_t>(py) * static_cast<std::size_t>(size.width) +
                 static_cast<std::size_t>(px)];
  };
  const int above = pixel(x0, y0) * (256 - fx) + pixel(x1, y0) * fx;
  const int below = pixel(x0, y1) * (256 - fx) + pixel(x1, y1) * fx;
  return (above * (256 - fy) + below * fy + 2048) >> 12;
}

}  // namespace

void golden_resample(Picture size, std::span<const std::uint8_t> image,
                     std::span<const std::int32_t> windows, int side,
                     std::span<std::uint16_t> patches) {
  std::size_t out = 0;
  for (std::size_t w = 0; w < windows.size(); w += kWindowEntries) {
    const int shift = windows[w + 4];
    const int taps = 1 << shift;
    // Of the taps' centres the middle is the sample's.
    const int pitch_x = windows[w + 2] >> shift;
    const int pitch_y = windows[w + 3] >> shift;
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const int x = windows[w] + i * windows[w + 2] - pitch_x * (taps - 1) / 2;
        const int y = windows[w + 1] + j * windows[w + 3] - pitch_y * (taps - 1) / 2;
        int sum = 0;
        for (int v = 0; v < taps; ++v) {
          for (int u = 0; u < taps; ++u)
            sum += sample(size, image, x + u * pitch_x, y + v * pitch_y);
        }
        patches[out++] = static_cast<std::uint16_t>((sum + (taps * taps) / 2) >> (2 * shift));
      }
    }
  }
}

void golden_cell_histograms(std::span<const std::uint16_t> patches, int cells,
                            std::span<std::int32_t> histograms) {
  const int side = kCell * cells;
  const std::size_t plane = plane_size(cells);
  const std::size_t count = histograms.size() / (plane * kBins);
  std::fill(histograms.begin(), histograms.end(), 0);
  for (std::size_t p = 0; p < count; ++p) {
    const auto patch = patches.subspan(p * static_cast<std::size_t>(side * side));
    const auto pixel = [&](int x, int y) -> int {
      return patch[static_cast<std::size_t>(std::clamp(y, 0, side - 1) * side +
                                            std::clamp(x, 0, side - 1))];
    };
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const int dx = pixel(x + 1, y) - pixel(x - 1, y);
        const int dy = pixel(x, y + 1) - pixel(x, y - 1);
        int longest = 0;
        int bin = 0;
        for (std::size_t o = 0; o < kDirections; ++o) {
          const int along = dx * kCosines[o] + dy * kSines[o];
          if (std::abs(along) <= longest) continue;
          longest = std::abs(along);
          bin = static_cast<int>(o) + (along < 0 ? kDirections : 0);
        }
        // The cells whose eight pixels this one is among.
        for (int cy = 0; cy < cells; ++cy) {
          const int v = y - (kCell * cy - 2);
          if (v < 0 || v >= 8) continue;
          for (int cx = 0; cx < cells; ++cx) {
            const int u = x - (kCell * cx - 2);
            if (u < 0 || u >= 8) continue;
            const std::size_t at = (p * kBins + static_cast<std::size_t>(bin)) * plane +
                                   static_cast<std::size_t>(cy * cells + cx);
            histograms[at] += (longest >> 7) * kWeights[static_cast<std::size_t>(u)] *
                              kWeights[static_cast<std::size_t>(v)];
          }
        }
      }
    }
  }
}

void golden_cell_features(std::span<const std::int32_t> histograms, std::span<const float> taper,
                          int cells, std::span<float> features) {
  const std::size_t plane = plane_size(cells);
  const std::size_t count = features.size() / (plane * kChannels);
  std::vector<float> energy(plane);
  for (std::size_t p = 0; p < count; ++p) {
    const auto histogram = [&](std::size_t bin, std::size_t cell) {
      return static_cast<float>(histograms[(p * kBins + bin) * plane + cell]);  // below 2^24: exact
    };
    for (std::size_t cell = 0; cell < plane; ++cell) {
      energy[cell] = 0;
      for (std::size_t o = 0; o < kDirections; ++o) {
        const float both = histogram(o, cell) + histogram(o + kDirections, cell);
        energy[cell] = std::fma(both, both, energy[cell]);
      }
    }
    const auto energy_at = [&](int x, int y) {
      return energy[static_cast<std::size_t>(std::clamp(y, 0, cells - 1) * cells +
                                             std::clamp(x, 0, cells - 1))];
    };
    for (int y = 0; y < cells; ++y) {
      for (int x = 0; x < cells; ++x) {
        const auto cell = static_cast<std::size_t>(y * cells + x);
        std::array<float, 4> norm{};
        for (std::size_t k = 0; k < 4; ++k) {
          const int bx = k % 2 == 0 ? -1 : 1;
          const int by = k < 2 ? -1 : 1;
          const float sum = (energy_at(x, y) + energy_at(x + bx, y)) +
                            (energy_at(x, y + by) + energy_at(x + bx, y + by));
          norm[k] = reciprocal_root(sum + kEnergyFloor);
        }
        const float window =
            taper[static_cast<std::size_t>(y)] * taper[static_cast<std::size_t>(x)];
        const auto store = [&](std::size_t channel, float value) {
          features[(p * kChannels + channel) * plane + cell] = value * window;
        };
        std::array<float, 4> texture{};
        for (std::size_t o = 0; o < kBins; ++o) {
          float sum = 0;
          for (std::size_t k = 0; k < 4; ++k) {
            const float cut = std::min(histogram(o, cell) * norm[k], 0.2f);
            sum = sum + cut;
            texture[k] = texture[k] + cut;
          }
          store(o, 0.5f * sum);
        }
        for (std::size_t o = 0; o < kDirections; ++o) {
          const float both = histogram(o, cell) + histogram(o + kDirections, cell);
          float sum = 0;
          for (std::size_t k = 0; k < 4; ++k) sum = sum + std::min(both * norm[k], 0.2f);
          store(kBins + o, 0.5f * sum);
        }
        for (std::size_t k = 0; k < 4; ++k) {
          store(kBins + kDirections + k, 0.2357f * texture[k]);
        }
      }
    }
  }
}

}  // namespace partita::tracking
