#include <algorithm>
#include <bit>
#include <cstdlib>

#include "host/tasks/frontend/golden.h"

namespace partita::frontend::golden {
namespace {

/// One query against all features.
Match best_match(const Keypoint& query, const Descriptor& descriptor, Shift shift,
                 std::span<const Keypoint> trains, std::span<const Descriptor> train_descriptors,
                 const Window& window, int max_hamming, int ratio_q8) {
  const int x = query.x_q8 + shift.x_q8;
  const int y = query.y_q8 + shift.y_q8;
  Match best;
  int second = kNoDistance;
  for (std::size_t i = 0; i < trains.size(); ++i) {
    const Keypoint& train = trains[i];
    const int dx = train.x_q8 - x;
    const int dy = train.y_q8 - y;
    if (train.level() != query.level() || dx < window.x_least || dx > window.x_most ||
        dy < window.y_least || dy > window.y_most) {
      continue;
    }
    const int distance = hamming(descriptor, train_descriptors[i]);
    if (distance < best.distance) {
      second = best.distance;
      best = {static_cast<int>(i), distance};
    } else {
      second = std::min(second, distance);
    }
  }
  const bool accepted = best.distance <= max_hamming && best.distance * 256 <= second * ratio_q8;
  return accepted ? best : Match{};
}

int sad(const GrayImage& a, int ax, int ay, const GrayImage& b, int bx, int by) {
  int sum = 0;
  for (int dy = -kSadRadius; dy <= kSadRadius; ++dy) {
    for (int dx = -kSadRadius; dx <= kSadRadius; ++dx) {
      sum += std::abs(a.at(ax + dx, ay + dy) - b.at(bx + dx, by + dy));
    }
  }
  return sum;
}

RefinedMatch refine(const GrayImage& a, const GrayImage& b, const Keypoint& from,
                    const Keypoint& to, int index, const RefineOptions& options) {
  const int y_centre = options.same_row ? from.y() : to.y();
  const auto cost = [&](int dx, int dy) {
    return sad(a, from.x(), from.y(), b, to.x() + dx, y_centre + dy);
  };
  int best_x = 0;
  int best_y = 0;
  int least = -1;
  for (int dy = -options.range_y; dy <= options.range_y; ++dy) {
    for (int dx = -options.range_x; dx <= options.range_x; ++dx) {
      const int c = cost(dx, dy);
      if (least >= 0 && c >= least) continue;
      least = c;
      best_x = dx;
      best_y = dy;
    }
  }
  if (least > options.max_sad || std::abs(best_x) == options.range_x ||
      (options.range_y > 0 && std::abs(best_y) == options.range_y)) {
    return {};
  }
  const int level = from.level();
  const auto scaled = [level](int step) { return level == 0 ? step : step * 307 / 256; };
  RefinedMatch result{to_original_q8(to.x() + best_x, level),
                      to_original_q8(y_centre + best_y, level), index, least};
  result.x_q8 += scaled(parabola_q8(cost(best_x - 1, best_y), least, cost(best_x + 1, best_y)));
  if (options.range_y > 0) {
    result.y_q8 += scaled(parabola_q8(cost(best_x, best_y - 1), least, cost(best_x, best_y + 1)));
  }
  return result;
}

}  // namespace

int hamming(const Descriptor& a, const Descriptor& b) {
  int distance = 0;
  for (std::size_t i = 0; i < a.size(); ++i) distance += std::popcount(a[i] ^ b[i]);
  return distance;
}

std::vector<Match> match_window(std::span<const Keypoint> queries,
                                std::span<const Descriptor> query_descriptors,
                                std::span<const Shift> shifts, std::span<const Keypoint> trains,
                                std::span<const Descriptor> train_descriptors, const Window& window,
                                int max_hamming, int ratio_q8) {
  std::vector<Match> matches(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (shifts[i].x_q8 == kNoPrediction) continue;
    matches[i] = best_match(queries[i], query_descriptors[i], shifts[i], trains, train_descriptors,
                            window, max_hamming, ratio_q8);
  }
  return matches;
}

std::vector<Match> invert_matches(std::span<const Match> matches, int trains) {
  std::vector<Match> inverse(static_cast<std::size_t>(trains));
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (matches[i].index < 0) continue;
    Match& entry = inverse[static_cast<std::size_t>(matches[i].index)];
    if (matches[i].distance < entry.distance) entry = {static_cast<int>(i), matches[i].distance};
  }
  return inverse;
}

int parabola_q8(int before, int best, int after) {
  const int curvature = before - 2 * best + after;
  return curvature == 0 ? 0 : 128 * (before - after) / curvature;
}

std::vector<RefinedMatch> refine_sad(std::span<const GrayImage> a, std::span<const GrayImage> b,
                                     std::span<const Keypoint> keypoints_a,
                                     std::span<const Keypoint> keypoints_b,
                                     std::span<const Match> matches, std::span<const Match> inverse,
                                     const RefineOptions& options) {
  std::vector<RefinedMatch> refined(keypoints_a.size());
  for (std::size_t i = 0; i < keypoints_a.size(); ++i) {
    const int other = matches[i].index;
    if (other < 0) continue;
    const auto partner = static_cast<std::size_t>(other);
    if (inverse[partner].index != static_cast<int>(i)) continue;
    const auto level = static_cast<std::size_t>(keypoints_a[i].level());
    refined[i] = refine(a[level], b[level], keypoints_a[i], keypoints_b[partner], other, options);
  }
  return refined;
}

}  // namespace partita::frontend::golden
