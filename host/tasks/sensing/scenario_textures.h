// The scenario's surfaces: gray tiles made of hashed noise, bricks, windows and markings, each with
// its reduced versions.
#ifndef PARTITA_HOST_TASKS_SENSING_SCENARIO_TEXTURES_H
#define PARTITA_HOST_TASKS_SENSING_SCENARIO_TEXTURES_H

#include <cstdint>
#include <vector>

namespace partita::sensing::scenario {

/// A tile that repeats without a seam, sides powers of two, and its box-filtered reductions by 2^i
/// along u and 2^j along v independently (a "ripmap"): a street surface is seen at grazing angles,
/// where a reduction by the same factor both ways would alias along one axis or blur the other.
class Texture {
 public:
  /// texels: log2_width, log2_height give the sides; row-major. per_metre: texels per metre.
  Texture(int log2_width, int log2_height, double texels_per_metre,
          std::vector<std::uint8_t> texels);

  /// One reduction: texel (x, y) is at data[((y & mask_v) << shift) + (x & mask_u)].
  struct Level {
    const std::uint8_t* data;
    std::int32_t mask_u;
    std::int32_t mask_v;
    std::int32_t shift;
  };
  const Level& level(int along_u, int along_v) const {
    return levels_[static_cast<std::size_t>(along_v * levels_u_ + along_u)];
  }
  int max_level_u() const { return levels_u_ - 1; }
  int max_level_v() const { return levels_v_ - 1; }
  double texels_per_metre() const { return texels_per_metre_; }

 private:
  int levels_u_;
  int levels_v_;
  double texels_per_metre_;
  std::vector<std::vector<std::uint8_t>> store_;
  std::vector<Level> levels_;
};

inline constexpr int kFacadeStyles = 5;

/// All tiles of the world. Road: u across the street (column 512 is its centre line), v along it.
/// Facades: u along the wall, v up from the ground, four storeys and four bays per tile.
struct TextureSet {
  Texture road;
  std::vector<Texture> facades;
  Texture roof;
  Texture leaves;
  Texture bark;
  Texture cloth;
  Texture skin;
  Texture car_side;   ///< u along the car, v up
  Texture car_front;  ///< u across the car, v up
  Texture glass;
  Texture rubber;
  Texture clouds;

  explicit TextureSet(std::uint64_t seed);
};

/// Half-widths of the street, metres from its centre line, as the road tile paints them.
inline constexpr double kLaneEdge = 3.2;
inline constexpr double kKerb = 5.3;
inline constexpr double kPavementEdge = 8.8;

}  // namespace partita::sensing::scenario

#endif  // PARTITA_HOST_TASKS_SENSING_SCENARIO_TEXTURES_H
