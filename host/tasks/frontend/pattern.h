// The descriptor's test pattern, after "BRIEF: Binary Robust Independent Elementary Features"
// (Calonder et al., 2010): pairs of points, each normally distributed about the centre. Our own
// seeded pattern, turned into one set of pairs per direction ("steered", as in the ORB paper).
#ifndef PARTITA_HOST_TASKS_FRONTEND_PATTERN_H
#define PARTITA_HOST_TASKS_FRONTEND_PATTERN_H

#include <array>
#include <cstdint>
#include <vector>

namespace partita::frontend {

inline constexpr int kBins = 32;
inline constexpr int kTests = 256;
inline constexpr int kPatchRows = 31;
inline constexpr int kPatchStride = 32;  ///< row length of the patch that the offsets index

/// One test before turning: the points (x0, y0) and (x1, y1) from the centre, at most 14 away.
struct TestPair {
  int x0, y0, x1, y1;
};
const std::array<TestPair, kTests>& base_pattern();

/// For every direction bin and test the offsets of both points in the patch of 31 rows of 32 pixels
/// (centre at row 15, column 15): kBins x kTests x 2. Bin b turns the pattern by the bin's middle,
/// (b + 1/2) / 32 of a full turn; turned points stay within the patch.
const std::vector<std::uint16_t>& test_table();

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_PATTERN_H
