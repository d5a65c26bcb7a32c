// What the cost of a depth frame depends on, beyond the pictures' size: known once it ran.
#ifndef PARTITA_HOST_TASKS_DEPTH_COUNTS_H
#define PARTITA_HOST_TASKS_DEPTH_COUNTS_H

#include <array>
#include <cstdint>

namespace partita::depth {

/// Of one view's mesh and of its grid prior.
struct ViewCounts {
  std::int64_t triangles = 0;
  std::int64_t spans = 0;     ///< Σ of the triangles' heights: rows of pixels to fill
  std::int64_t covered = 0;   ///< the triangles' area, px
  std::int64_t overlaps = 0;  ///< Σ of the bands of rows that each triangle touches
  std::int64_t entries = 0;   ///< Σ over the pixels of the disparities listed for their cells
  bool operator==(const ViewCounts&) const = default;
};

struct FrameCounts {
  std::int64_t support_points = 0;
  std::array<ViewCounts, 2> views;  ///< left, right; no triangles: the frame ended there
  bool operator==(const FrameCounts&) const = default;
};

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_COUNTS_H
