// Sizes that the depth task's host side and its kernels agree on; the kernels' copies are in
// kernels/depth/constants.clh.
#ifndef PARTITA_HOST_TASKS_DEPTH_GEOMETRY_H
#define PARTITA_HOST_TASKS_DEPTH_GEOMETRY_H

#include <cstddef>
#include <cstdint>

#include "host/runtime/kernel_spec.h"
#include "host/tasks/depth/golden.h"

namespace partita::depth {

inline constexpr std::int64_t kBand = 16;      ///< rows of a CPU work-item
inline constexpr int kLargestDisparity = 255;  ///< a disparity fits a byte
inline constexpr int kLargestWindow = 16;      ///< grid steps, of the plausibility test
inline constexpr int kLargestRadius = 16;      ///< px, around a plane
inline constexpr int kSmallestCell = 8;        ///< px, of the grid prior
inline constexpr int kLargestCell = 64;
inline constexpr std::int64_t kFpgaWidth = 1600;   ///< pixels that an FPGA row buffer holds
inline constexpr std::int64_t kFpgaColumns = 512;  ///< grid points that an FPGA row buffer holds
inline constexpr int kSmallestWidth = 32;
inline constexpr int kSmallestHeight = 16;
inline constexpr int kLargestSide = 4096;

inline constexpr std::int64_t ceil_div(std::int64_t a, std::int64_t b) {
  return (a + b - 1) / b;
}

/// Support grid of a picture.
inline Size grid_size(Size size, int step) {
  return {static_cast<int>(ceil_div(size.width, step)),
          static_cast<int>(ceil_div(size.height, step))};
}
/// Cells of the grid prior.
inline Size cell_size(Size size, int cell) {
  return {static_cast<int>(ceil_div(size.width, cell)),
          static_cast<int>(ceil_div(size.height, cell))};
}
inline std::size_t area(Size size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

/// `count` single work-items.
inline runtime::LaunchGeometry single_items(std::int64_t count) {
  return {{static_cast<std::size_t>(count), 1, 1}, {1, 1, 1}};
}
/// Groups of local_x x local_y over width x height, rounded up.
inline runtime::LaunchGeometry groups_over(std::int64_t width, std::int64_t height,
                                           std::int64_t local_x, std::int64_t local_y) {
  const auto x = static_cast<std::size_t>(ceil_div(width, local_x) * local_x);
  const auto y = static_cast<std::size_t>(ceil_div(height, local_y) * local_y);
  return {{x, y, 1}, {static_cast<std::size_t>(local_x), static_cast<std::size_t>(local_y), 1}};
}

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_GEOMETRY_H
