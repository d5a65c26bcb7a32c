// Golden references of the depth kernels: plain C++, one pixel at a time, no cleverness. The
// kernels of all variants must give exactly these numbers. Pictures and maps are row-major.
#ifndef PARTITA_HOST_TASKS_DEPTH_GOLDEN_H
#define PARTITA_HOST_TASKS_DEPTH_GOLDEN_H

#include <cstdint>
#include <span>

namespace partita::depth {

struct Size {
  int width = 0;
  int height = 0;
};

inline constexpr int kDescriptorBytes = 16;
/// Pixels from the border at which a descriptor two pixels away is still made of whole windows.
inline constexpr int kMargin = 5;
/// Words of 32 bits that mark the disparities seen in a cell.
inline constexpr int kSeenWords = 8;
/// Disparities have this many fractional bits in the plane prior's map.
inline constexpr int kPlaneBits = 4;
/// A pixel for which no plane speaks.
inline constexpr std::int16_t kNoPlane = INT16_MIN;
/// Energies count sixteenths of a grey level of descriptor distance.
inline constexpr int kEnergyScale = 16;
/// Entries of the prior's table: |d - μ| in sixteenths up to the radius, then "not near the plane".
inline constexpr int prior_entries(int radius) {
  return (radius << kPlaneBits) + 2;
}

/// 128 + the 3x3 Sobel response / 4, rounded down and held to 0..255; the picture's edge repeats.
void golden_sobel(Size size, std::span<const std::uint8_t> image, std::span<std::uint8_t> du,
                  std::span<std::uint8_t> dv);

/// Twelve samples of du and four of dv around each pixel; see golden_descriptor.cpp for which.
void golden_descriptor(Size size, std::span<const std::uint8_t> du,
                       std::span<const std::uint8_t> dv, std::span<std::uint8_t> descriptors);

struct SupportRules {
  int max_disparity = 0;
  int step = 0;
  int texture = 0;
  int ratio_percent = 0;
  int lr_threshold = 0;
};
/// Disparity of each point of the grid (columns x rows, at multiples of `step`), -1 where it cannot
/// be matched safely.
void golden_support_match(Size size, std::span<const std::uint8_t> left,
                          std::span<const std::uint8_t> right, const SupportRules& rules,
                          std::span<std::int16_t> grid);

/// How many points of the grid are matched distinctly from left to right.
std::int64_t golden_distinct_points(Size size, std::span<const std::uint8_t> left,
                                    std::span<const std::uint8_t> right, const SupportRules& rules);

/// Copies the grid without the points that fewer than `least` points in the window of +-`window`
/// grid steps (the point itself included) agree with to within `threshold`.
void golden_support_plausible(Size grid_size, std::span<const std::int16_t> grid, int window,
                              int threshold, int least, std::span<std::int16_t> out);

/// Walks each row (or column) and removes a point when the nearest `reach` positions before it, as
/// they are after removal, and those behind it both hold a point that differs by at most
/// `threshold`.
void golden_support_redundant(Size grid_size, bool vertical, int reach, int threshold,
                              std::span<std::int16_t> grid);

/// (u, v, d, 0) of each point by row, then column; count[0] is their number.
void golden_support_list(Size grid_size, int step, std::span<const std::int16_t> grid,
                         std::span<std::int16_t> list, std::span<std::uint32_t> count);

/// Marks for each cell the disparities d-1, d, d+1 of the support points in it, those of 0 ..
/// max_disparity: bit d % 32 of word d / 32 of the cell's kSeenWords. In the right view a point
/// sits at u - d.
void golden_grid_seen(Size size, int cell, Size grid_size, std::span<const std::int16_t> grid,
                      int step, int max_disparity, bool right, std::span<std::uint32_t> seen);

/// For each cell the ascending disparities marked for it or one of its eight neighbours. Lists have
/// max_disparity + 1 places.
void golden_grid_prior(Size cells, std::span<const std::uint32_t> seen, int max_disparity,
                       std::span<std::uint16_t> counts, std::span<std::uint8_t> lists);

/// Disparity of the plane of the triangle that covers each pixel, in 1/16 px. `corners` holds
/// 8 numbers for each triangle (u, v of three corners, two unused), `planes` 4 (see planes.h).
void golden_plane_prior(Size size, std::span<const std::int16_t> corners,
                        std::span<const std::int32_t> planes, int triangles,
                        std::span<std::int16_t> map);

struct DenseRules {
  int cell = 0;
  int max_disparity = 0;
  int radius = 0;  ///< disparities less than this from the plane are tried, px
  int texture = 0;
  bool right = false;
};
/// The candidate with the least energy, as in DisparityMap: 0 for a pixel without texture or
/// without candidate. In the left view a parabola through the distances at the disparity and its
/// neighbours refines it.
void golden_dense_match(Size size, std::span<const std::uint8_t> own,
                        std::span<const std::uint8_t> other, std::span<const std::int16_t> map,
                        std::span<const std::uint16_t> counts, std::span<const std::uint8_t> lists,
                        std::span<const std::uint16_t> prior, const DenseRules& rules,
                        std::span<std::uint16_t> disparities);

/// The left view's disparities that the right view's confirm; 0 elsewhere.
void golden_consistency(Size size, std::span<const std::uint16_t> left,
                        std::span<const std::uint16_t> right, int lr_threshold,
                        std::span<std::uint16_t> out);

/// Segments inside bands of kBand rows; kernels/depth/segments.gpu.cl says what labels and sizes
/// are, here and after joining. `similarity` is in 1/256 px.
void golden_segments(Size size, std::span<const std::uint16_t> map, int similarity,
                     std::span<std::int32_t> labels, std::span<std::int32_t> sizes);
void golden_join_segments(Size size, std::span<const std::uint16_t> map, int similarity,
                          std::span<std::int32_t> labels, std::span<std::int32_t> sizes);
/// Clears the disparities of segments of fewer than `least` pixels.
void golden_remove_speckles(std::span<const std::int32_t> labels,
                            std::span<const std::int32_t> sizes, int least,
                            std::span<std::uint16_t> map);

/// Fills gaps of up to `gap` pixels in each row (or column): by the mean of the disparities at
/// their ends if these differ by less than 3 px, else by the smaller one, which is the
/// background's. With `extend` the first and last disparity go on for up to `gap` pixels towards
/// the ends of the line.
void golden_fill_gaps(Size size, bool vertical, int gap, bool extend, std::span<std::uint16_t> map);

/// Along rows (or columns) each disparity becomes the mean of the nine around it, weighted by 4 px
/// less their difference to it; those four from an end, or nearer, stay.
void golden_adaptive_mean(Size size, bool vertical, std::span<const std::uint16_t> map,
                          std::span<std::uint16_t> out);
/// The same with the median of seven; pixels without disparity count as the least.
void golden_median(Size size, bool vertical, std::span<const std::uint16_t> map,
                   std::span<std::uint16_t> out);

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_GOLDEN_H
