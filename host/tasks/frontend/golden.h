// Golden references of the front-end's kernels: plain C++, one pixel or feature at a time, written
// from the definitions and not from the kernels. What each computes is said at the kernel's GPU
// text.
#ifndef PARTITA_HOST_TASKS_FRONTEND_GOLDEN_H
#define PARTITA_HOST_TASKS_FRONTEND_GOLDEN_H

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "host/tasks/frontend/layout.h"
#include "host/tasks/sensing/frame.h"

namespace partita::frontend::golden {

using sensing::GrayImage;
using Descriptor = std::array<std::uint32_t, 8>;

GrayImage pyramid_down(const GrayImage& image);

/// Score of one pixel at least 3 from the edges: the largest, over all arcs of nine and both signs,
/// of the least difference to the centre; 0 if none is positive.
int fast_score_at(const GrayImage& image, int x, int y);
GrayImage fast_score(const GrayImage& image, int threshold);

GrayImage gaussian_blur(const GrayImage& image);

std::uint32_t corner_key(int score, int x, int y);
std::pair<int, int> key_position(std::uint32_t key);  ///< x, y
/// kPerCell keys per cell of the grid.
std::vector<std::uint32_t> select_cells(const GrayImage& score, int cell, int threshold_high);

struct FeatureList {
  std::vector<Keypoint> keypoints;
  std::vector<std::int32_t> cell_start;  ///< cells + 1
};
FeatureList compact(std::span<const std::uint32_t> slots, int cells_level0);

/// Moments (m10, m01) of the circular patch of radius 15.
std::pair<int, int> moments(const GrayImage& image, int x, int y);
int direction_bin(int m10, int m01);
Descriptor describe(const GrayImage& blurred, int x, int y, int bin,
                    std::span<const std::uint16_t> table);

int hamming(const Descriptor& a, const Descriptor& b);
std::vector<Match> match_window(std::span<const Keypoint> queries,
                                std::span<const Descriptor> query_descriptors,
                                std::span<const Shift> shifts, std::span<const Keypoint> trains,
                                std::span<const Descriptor> train_descriptors, const Window& window,
                                int max_hamming, int ratio_q8);
std::vector<Match> invert_matches(std::span<const Match> matches, int trains);

struct RefineOptions {
  int range_x = 5;
  int range_y = 0;
  bool same_row = true;
  int max_sad = 3000;
};
/// Vertex of the parabola through three costs, in 1/256 pixel; `best` is the least.
int parabola_q8(int before, int best, int after);
std::vector<RefinedMatch> refine_sad(std::span<const GrayImage> a, std::span<const GrayImage> b,
                                     std::span<const Keypoint> keypoints_a,
                                     std::span<const Keypoint> keypoints_b,
                                     std::span<const Match> matches, std::span<const Match> inverse,
                                     const RefineOptions& options);

}  // namespace partita::frontend::golden

#endif  // PARTITA_HOST_TASKS_FRONTEND_GOLDEN_H
