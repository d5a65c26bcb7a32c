#include "host/tasks/sensing/scenario_textures.h"

#include <algorithm>
#include <utility>

#include "host/tasks/sensing/scenario_math.h"

namespace partita::sensing::scenario {

namespace {

using Texels = std::vector<std::uint8_t>;

std::size_t area(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

Texels halve_u(const Texels& in, int width, int height) {
  Texels out(area(width / 2, height));
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = static_cast<std::uint8_t>((in[2 * i] + in[2 * i + 1] + 1) / 2);
  }
  return out;
}

Texels halve_v(const Texels& in, int width, int height) {
  Texels out(area(width, height / 2));
  const auto stride = static_cast<std::size_t>(width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height / 2); ++y) {
    for (std::size_t x = 0; x < stride; ++x) {
      const std::size_t at = 2 * y * stride + x;
      out[y * stride + x] = static_cast<std::uint8_t>((in[at] + in[at + stride] + 1) / 2);
    }
  }
  return out;
}

/// Seamless noise around 0: octaves of interpolated random lattices, from cells of 2^coarsest
/// texels down to single ones. Every octave keeps its amplitude but for `falloff` per step to finer
/// ones, so that a surface shows contrast near and far, as real ones do.
class Noise {
 public:
  Noise(int width, int height, std::uint64_t seed, int coarsest, float amplitude, float falloff)
      : width_(width), values_(area(width, height), 0.0F) {
    for (int octave = coarsest; octave >= 0; --octave, amplitude *= falloff) {
      add_octave(height, hash(seed, static_cast<std::uint64_t>(octave)), octave, amplitude);
    }
  }
  float at(int x, int y) const { return values_[area(width_, y) + static_cast<std::size_t>(x)]; }

 private:
  void add_octave(int height, std::uint64_t seed, int octave, float amplitude) {
    const int columns = width_ >> octave;
    const int rows = height >> octave;
    std::vector<float> lattice(area(columns, rows));
    for (std::size_t i = 0; i < lattice.size(); ++i) {
      lattice[i] = static_cast<float>(hash(seed, i) >> 40) * (2.0F / 16777216.0F) - 1.0F;
    }
    const float step = 1.0F / static_cast<float>(1 << octave);
    for (int y = 0; y < height; ++y) {
      const float* upper = &lattice[area(columns, y >> octave)];
      const float* lower = &lattice[area(columns, ((y >> octave) + 1) % rows)];
      const float fy = static_cast<float>(y & ((1 << octave) - 1)) * step;
      float* out = &values_[area(width_, y)];
      for (int x = 0; x < width_; ++x) {
        const int i = x >> octave;
        const int j = i + 1 == columns ? 0 : i + 1;
        const float fx = static_cast<float>(x & ((1 << octave) - 1)) * step;
        const float a = upper[i] + (upper[j] - upper[i]) * fx;
        const float b = lower[i] + (lower[j] - lower[i]) * fx;
        out[x] += amplitude * (a + (b - a) * fy);
      }
    }
  }

  int width_;
  std::vector<float> values_;
};

std::uint8_t gray(float value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F));
}

/// A tile of 2^log2_width x 2^log2_height, each texel from paint(x, y).
template <class Paint>
Texture painted(int log2_width, int log2_height, double texels_per_metre, Paint paint) {
  const int width = 1 << log2_width;
  const int height = 1 << log2_height;
  Texels texels(area(width, height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      texels[area(width, y) + static_cast<std::size_t>(x)] = gray(paint(x, y));
    }
  }
  return {log2_width, log2_height, texels_per_metre, std::move(texels)};
}

/// Plain material: a mean and noise.
Texture rough(std::uint64_t seed, float mean, float amplitude, float falloff) {
  const Noise noise(256, 256, seed, 5, amplitude, falloff);
  return painted(8, 8, 60.0, [&](int x, int y) { return mean + noise.at(x, y); });
}

float tone(std::uint64_t seed, int a, int b) {  // -1 .. 1
  return static_cast<float>(2.0 * uniform(seed, key(a), key(b)) - 1.0);
}

Texture road_texture(std::uint64_t seed) {
  const Noise noise(1024, 1024, hash(seed, 1), 7, 6.0F, 1.22F);
  const auto paint = [&](int x, int y) {
    const float across = (static_cast<float>(x) - 511.5F) * 0.02F;
    const float from_centre = across < 0 ? -across : across;
    const float grain = noise.at(x, y);
    if (from_centre < 0.075F) return (y % 512) < 200 ? 215.0F + 0.5F * grain : 104.0F + grain;
    if (from_centre > 3.15F && from_centre < 3.25F) {
      return (y % 256) < 60 ? 195.0F + 0.5F * grain : 104.0F + grain;
    }
    if (from_centre < 5.0F) {
      const int manhole_x = x - (across < 0 ? 440 : 612);
      const int manhole_y = (y % 1024) - (across < 0 ? 300 : 760);
      const int r2 = manhole_x * manhole_x + manhole_y * manhole_y;
      if (r2 < 18 * 18) {
        return ((x / 3 + y / 3) % 2 == 0 || r2 > 15 * 15 ? 48.0F : 105.0F) + 0.4F * grain;
      }
      const bool patch = across > 0
                             ? (y > 560 && y < 690 && from_centre > 2.0F)
                             : (y > 90 && y < 330 && from_centre > 1.4F && from_centre < 2.6F);
      return (patch ? 78.0F : 104.0F) + grain;
    }
    if (from_centre < 5.3F) return 66.0F + grain;                                 // gutter
    if (from_centre < 5.5F) return (y % 50) < 2 ? 90.0F : 160.0F + 0.6F * grain;  // kerb stones
    if (from_centre < 8.8F) {                                                     // slabs
      const int row = y / 32;
      const int column = (x + (row % 2) * 16) / 32;
      const bool joint = y % 32 < 1 || (x + (row % 2) * 16) % 32 < 1;
      return joint ? 92.0F : 140.0F + 18.0F * tone(seed, column, row) + 0.7F * grain;
    }
    return 96.0F + 1.5F * grain;  // grass
  };
  return painted(10, 10, 50.0, paint);
}

constexpr int kBay = 128;  // texels; 3.2 m

/// The wall between the windows. x along, y up.
float wall(int style, std::uint64_t seed, int x, int y) {
  const bool flat = style == 1 || style == 4;
  if (flat) return style == 1 ? 178.0F : 140.0F;
  const int height = style == 0 ? 4 : style == 2 ? 16 : 8;
  const int width = style == 0 ? 8 : 32;
  const int row = y / height;
  const int shifted = x + (row % 2) * width / 2;
  const float mean = style == 0 ? 118.0F : style == 2 ? 152.0F : 128.0F;
  const bool joint = y % height == 0 || shifted % width == 0;
  if (joint) return mean - (style == 0 ? -38.0F : 45.0F);
  return mean + 26.0F * tone(seed, (shifted / width) % (512 / width), row);
}

/// Window, door or shop front in one bay; returns a negative value where the wall shows.
float opening(int style, std::uint64_t seed, int x, int y) {
  const int bay = x / kBay;
  const int storey = y / kBay;
  const int u = x % kBay;
  const int v = y % kBay;
  const bool door = storey == 0 && bay == style % 4;
  const int half = door ? 22 : storey == 0 && style % 2 == 1 ? 50 : 24 + 3 * (style % 3);
  const int bottom = door ? 0 : storey == 0 && style % 2 == 1 ? 18 : 36;
  const int top = door ? 92 : 104;
  const int from_middle = u < 64 ? 63 - u : u - 64;
  if (v >= bottom - 5 && v < bottom && from_middle < half + 6 && !door) return 205.0F;  // sill
  if (v < bottom || v >= top || from_middle >= half) return -1.0F;
  if (from_middle >= half - 4 || v >= top - 4 || v < bottom + 4) return door ? 70.0F : 222.0F;
  if (door) return ((u / 14 + v / 22) % 2 == 0 ? 84.0F : 68.0F) + (from_middle < 1 ? -40.0F : 0.0F);
  if (from_middle < 2 || (v - bottom > 42 && v - bottom < 46)) return 214.0F;  // cross bars
  const bool curtain = uniform(seed, 77, key(bay), key(storey)) < 0.45;
  if (curtain && from_middle > half - 14) return 150.0F + static_cast<float>((u * 7) % 5) * 9.0F;
  const float sky = static_cast<float>(v - bottom) * 0.55F;
  return 34.0F + sky + 22.0F * tone(seed, bay * 4 + storey, 5) + ((u + v) % 37 < 6 ? 18.0F : 0.0F);
}

Texture facade_texture(std::uint64_t seed, int style) {
  const Noise noise(512, 512, hash(seed, 2, key(style)), 6, 4.5F, 1.2F);
  const std::uint64_t own = hash(seed, 3, key(style));
  return painted(9, 9, 40.0, [&](int x, int y) {
    const float grain = noise.at(x, y);
    const float hole = opening(style, own, x, y);
    if (hole >= 0) return hole + 0.35F * grain;
    const bool band = y % kBay > 120;  // a cornice between storeys
    return (band ? 190.0F : wall(style, own, x, y)) +
           (style == 1 || style == 4 ? 1.6F : 1.0F) * grain;
  });
}

Texture car_side_texture(std::uint64_t seed) {
  const Noise noise(256, 64, hash(seed, 4), 4, 5.0F, 0.9F);
  return painted(8, 6, 50.0, [&](int x, int y) {  // 5.1 x 1.3 m
    const float grain = noise.at(x, y);
    const bool seam = (x == 78 || x == 79 || x == 130 || x == 131 || x == 176) && y > 8;
    const bool handle = ((x > 112 && x < 122) || (x > 162 && x < 172)) && y > 28 && y < 32;
    if (seam || handle) return 30.0F + grain;
    if (y < 7) return 42.0F + grain;                                     // sill
    if (y > 17 && y < 21) return 105.0F + grain;                         // moulding
    if ((x < 12 || x > 214) && y > 24 && y < 33) return 236.0F + grain;  // lamps
    return 138.0F + 0.9F * static_cast<float>(y) + grain;
  });
}

Texture car_front_texture(std::uint64_t seed) {
  const Noise noise(128, 64, hash(seed, 5), 4, 5.0F, 0.9F);
  return painted(7, 6, 50.0, [&](int x, int y) {  // the middle is u = 0, hence column 0 of the tile
    const int u = x < 64 ? x : 127 - x;
    const float grain = noise.at(x, y);
    if (u > 30 && u < 43 && y > 24 && y < 34) return 240.0F + grain;                   // lamps
    if (u < 13 && y > 12 && y < 19) return (x / 2 % 3 == 0 ? 60.0F : 225.0F) + grain;  // plate
    if (u < 27 && y > 22 && y < 32) return (y % 3 == 0 ? 130.0F : 38.0F) + grain;      // grille
    if (y < 9) return 45.0F + grain;
    return 135.0F + grain;
  });
}

}  // namespace

Texture::Texture(int log2_width, int log2_height, double texels_per_metre, Texels texels)
    : levels_u_(log2_width + 1), levels_v_(log2_height + 1), texels_per_metre_(texels_per_metre) {
  const int width = 1 << log2_width;
  const int height = 1 << log2_height;
  store_.reserve(static_cast<std::size_t>(levels_u_) * static_cast<std::size_t>(levels_v_));
  store_.push_back(std::move(texels));
  for (int v = 0; v < levels_v_; ++v) {
    if (v > 0) {
      const auto above = store_.size() - static_cast<std::size_t>(levels_u_);
      store_.push_back(halve_v(store_[above], width, height >> (v - 1)));
    }
    for (int u = 1; u < levels_u_; ++u) {
      store_.push_back(halve_u(store_.back(), width >> (u - 1), height >> v));
    }
  }
  for (int v = 0; v < levels_v_; ++v) {
    for (int u = 0; u < levels_u_; ++u) {
      levels_.push_back({store_[static_cast<std::size_t>(v * levels_u_ + u)].data(),
                         (width >> u) - 1, (height >> v) - 1, log2_width - u});
    }
  }
}

TextureSet::TextureSet(std::uint64_t seed)
    : road(road_texture(hash(seed, 201))),
      roof(painted(8, 8, 40.0,
                   [noise = Noise(256, 256, hash(seed, 202), 5, 9.0F, 1.0F), seed](int x, int y) {
                     const int row = y / 8;
                     const float tile = 12.0F * tone(seed, (x + (row % 2) * 4) / 8, row);
                     return (y % 8 == 0 ? 62.0F : 104.0F + tile) + noise.at(x, y);
                   })),
      leaves(rough(hash(seed, 203), 96.0F, 16.0F, 1.25F)),
      bark(rough(hash(seed, 204), 88.0F, 9.0F, 1.3F)),
      cloth(rough(hash(seed, 205), 124.0F, 7.0F, 1.1F)),
      skin(rough(hash(seed, 206), 172.0F, 8.0F, 1.0F)),
      car_side(car_side_texture(hash(seed, 207))),
      car_front(car_front_texture(hash(seed, 208))),
      glass(painted(6, 6, 40.0,
                    [noise = Noise(64, 64, hash(seed, 209), 5, 14.0F, 0.7F)](int x, int y) {
                      return 52.0F + noise.at(x, y) + ((x + y) % 41 < 7 ? 34.0F : 0.0F);
                    })),
      rubber(rough(hash(seed, 210), 44.0F, 8.0F, 1.0F)),
      clouds(painted(9, 9, 60.0,
                     [noise = Noise(512, 512, hash(seed, 211), 8, 14.0F, 0.62F)](int x, int y) {
                       return 214.0F + noise.at(x, y);
                     })) {
  for (int style = 0; style < kFacadeStyles; ++style) {
    facades.push_back(facade_texture(hash(seed, 212), style));
  }
}

}  // namespace partita::sensing::scenario
