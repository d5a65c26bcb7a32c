// How the front-end's kernels lay out their data; the device's side is kernels/frontend/common.clh.
#ifndef PARTITA_HOST_TASKS_FRONTEND_LAYOUT_H
#define PARTITA_HOST_TASKS_FRONTEND_LAYOUT_H

#include <array>
#include <cstdint>
#include <type_traits>

namespace partita::frontend {

inline constexpr int kLevels = 2;
inline constexpr int kBorder = 19;       ///< no feature nearer to a level's edge
inline constexpr int kPerCell = 4;       ///< features per cell at most
inline constexpr int kPatchRadius = 15;  ///< of orientation and descriptor
inline constexpr int kSadRadius = 5;
inline constexpr int kMinSize = 64;  ///< of an image, either side
inline constexpr int kMaxSize = 4096;
inline constexpr int kMaxFeatures = 2048;
inline constexpr int kNoDistance = 0xFFFF;
/// Shift of a query that is not to be matched.
inline constexpr std::int32_t kNoPrediction = -0x40000000;

struct Size {
  int width = 0;
  int height = 0;
  std::int64_t pixels() const { return std::int64_t{width} * height; }
  bool operator==(const Size&) const = default;
};

/// Size of pyramid level 0 or 1: level 1 has 5/6 of either side, rounded down.
Size level_size(Size image, int level);

/// The grid of square cells over a level's interior.
struct Grid {
  int cell = 0;
  int columns = 0;
  int rows = 0;
  int cells() const { return columns * rows; }
};
Grid make_grid(Size level, int cell);
/// The grid with the smallest even cell whose features cannot exceed `quota` (at least kPerCell).
Grid finest_grid(Size level, int quota);

/// Both levels' grids, laid so that they hold at most `max_features` features.
struct Grids {
  Size size;  ///< of the image
  std::array<Grid, kLevels> level;

  const Grid& at(int index) const { return level[static_cast<std::size_t>(index)]; }
  int cells() const { return level[0].cells() + level[1].cells(); }
  /// Features that they can hold.
  int capacity() const { return cells() * kPerCell; }
};
Grids make_grids(Size image, int max_features);

/// A keypoint as the device has it (int4).
struct Keypoint {
  std::int32_t x_q8 = 0;  ///< original image, times 256
  std::int32_t y_q8 = 0;
  std::int32_t at = 0;       ///< x | y << 16, pixels of its level
  std::int32_t details = 0;  ///< score | bin << 8 | level << 16

  int x() const { return at & 0xFFFF; }
  int y() const { return at >> 16; }
  int score() const { return details & 0xFF; }
  int bin() const { return (details >> 8) & 0xFF; }
  int level() const { return details >> 16; }
};
static_assert(sizeof(Keypoint) == 16 && std::is_trivially_copyable_v<Keypoint>);

/// A match of a query (int2): index in the other list or -1, Hamming distance.
struct Match {
  std::int32_t index = -1;
  std::int32_t distance = kNoDistance;
  bool operator==(const Match&) const = default;
};
static_assert(sizeof(Match) == 8);

/// A refined match (int4): position in the other image, original coordinates.
struct RefinedMatch {
  std::int32_t x_q8 = 0;
  std::int32_t y_q8 = 0;
  std::int32_t index = -1;  ///< in the other list, -1: refused
  std::int32_t sad = 0;
  bool operator==(const RefinedMatch&) const = default;
};
static_assert(sizeof(RefinedMatch) == 16);

/// Displacement of a query's predicted position from its own (int2).
struct Shift {
  std::int32_t x_q8 = 0;
  std::int32_t y_q8 = 0;
};
static_assert(sizeof(Shift) == 8);

/// Search window around a predicted position, q8, both ends included.
struct Window {
  int x_least = 0;
  int x_most = 0;
  int y_least = 0;
  int y_most = 0;
};

/// A level's pixel -> original image, times 256: at level 1, 1.2 x + 0.1 in 16.16 arithmetic.
int to_original_q8(int value, int level);

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_LAYOUT_H
