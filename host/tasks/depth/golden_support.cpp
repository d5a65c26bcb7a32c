#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>

#include "host/tasks/depth/golden.h"

namespace partita::depth {
namespace {

/// A view's descriptors, and how the other view's columns follow from a disparity.
struct View {
  Size size;
  std::span<const std::uint8_t> own;
  std::span<const std::uint8_t> other;
  int direction;  ///< -1: the match lies to the left (left view), +1: to the right
};

const std::uint8_t* descriptor(Size size, std::span<const std::uint8_t> all, int u, int v) {
  return &all[(static_cast<std::size_t>(v) * static_cast<std::size_t>(size.width) +
               static_cast<std::size_t>(u)) *
              kDescriptorBytes];
}

int distance(const std::uint8_t* a, const std::uint8_t* b) {
  int sum = 0;
  for (int k = 0; k < kDescriptorBytes; ++k) sum += std::abs(a[k] - b[k]);
  return sum;
}

int texture(const std::uint8_t* a) {
  int sum = 0;
  for (int k = 0; k < kDescriptorBytes; ++k) sum += std::abs(a[k] - 128);
  return sum;
}

/// Σ over the four descriptors at (±2, ±2).
int support_cost(const View& view, int u, int v, int d) {
  int sum = 0;
  for (const int dy : {-2, 2}) {
    for (const int dx : {-2, 2}) {
      sum += distance(descriptor(view.size, view.own, u + dx, v + dy),
                      descriptor(view.size, view.other, u + dx + view.direction * d, v + dy));
    }
  }
  return sum;
}

/// The best disparity if it is distinct: its cost is below ratio % of the best among those that
/// are not its neighbours. -1 otherwise.
int match(const View& view, int u, int v, const SupportRules& rules) {
  if (u < kMargin || u >= view.size.width - kMargin) return -1;
  if (texture(descriptor(view.size, view.own, u, v)) < rules.texture) return -1;
  const int room = view.direction < 0 ? u - kMargin : view.size.width - 1 - kMargin - u;
  const int last = std::min(rules.max_disparity, room);
  int best = -1;
  int best_cost = std::numeric_limits<int>::max();
  for (int d = 0; d <= last; ++d) {
    const int cost = support_cost(view, u, v, d);
    if (cost < best_cost) {
      best_cost = cost;
      best = d;
    }
  }
  int second_cost = -1;
  for (int d = 0; d <= last; ++d) {
    if (std::abs(d - best) <= 1) continue;
    const int cost = support_cost(view, u, v, d);
    if (second_cost < 0 || cost < second_cost) second_cost = cost;
  }
  if (second_cost < 0 || 100 * best_cost >= rules.ratio_percent * second_cost) return -1;
  return best;
}

}  // namespace

void golden_support_match(Size size, std::span<const std::uint8_t> left,
                          std::span<const std::uint8_t> right, const SupportRules& rules,
                          std::span<std::int16_t> grid) {
  const View left_view{size, left, right, -1};
  const View right_view{size, right, left, +1};
  const int columns = (size.width + rules.step - 1) / rules.step;
  const int rows = (size.height + rules.step - 1) / rules.step;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const int u = i * rules.step;
      const int v = j * rules.step;
      std::int16_t& cell = grid[static_cast<std::size_t>(j * columns + i)];
      cell = -1;
      if (v < kMargin || v >= size.height - kMargin) continue;
      const int d = match(left_view, u, v, rules);
      if (d < 0) continue;
      const int back = match(right_view, u - d, v, rules);
      if (back >= 0 && std::abs(back - d) <= rules.lr_threshold) {
        cell = static_cast<std::int16_t>(d);
      }
    }
  }
}

std::int64_t golden_distinct_points(Size size, std::span<const std::uint8_t> left,
                                    std::span<const std::uint8_t> right,
                                    const SupportRules& rules) {
  const View view{size, left, right, -1};
  std::int64_t points = 0;
  for (int v = 0; v < size.height; v += rules.step) {
    if (v < kMargin || v >= size.height - kMargin) continue;
    for (int u = 0; u < size.width; u += rules.step) points += match(view, u, v, rules) >= 0;
  }
  return points;
}

void golden_support_plausible(Size grid_size, std::span<const std::int16_t> grid, int window,
                              int threshold, int least, std::span<std::int16_t> out) {
  const auto at = [&](int i, int j) {
    return grid[static_cast<std::size_t>(j * grid_size.width + i)];
  };
  for (int j = 0; j < grid_size.height; ++j) {
    for (int i = 0; i < grid_size.width; ++i) {
      const int d = at(i, j);
      int support = 0;
      for (int y = std::max(0, j - window); y <= std::min(grid_size.height - 1, j + window); ++y) {
        for (int x = std::max(0, i - window); x <= std::min(grid_size.width - 1, i + window); ++x) {
          support += at(x, y) >= 0 && std::abs(at(x, y) - d) <= threshold;
        }
      }
      out[static_cast<std::size_t>(j * grid_size.width + i)] =
          static_cast<std::int16_t>(d >= 0 && support >= least ? d : -1);
    }
  }
}

void golden_support_redundant(Size grid_size, bool vertical, int reach, int threshold,
                              std::span<std::int16_t> grid) {
  const int lines = vertical ? grid_size.width : grid_size.height;
  const int length = vertical ? grid_size.height : grid_size.width;
  for (int line = 0; line < lines; ++line) {
    const auto at = [&](int k) -> std::int16_t& {
      const int index = vertical ? k * grid_size.width + line : line * grid_size.width + k;
      return grid[static_cast<std::size_t>(index)];
    };
    for (int k = 0; k < length; ++k) {
      if (at(k) < 0) continue;
      const auto near = [&](int other) {
        return other >= 0 && other < length && at(other) >= 0 &&
               std::abs(at(other) - at(k)) <= threshold;
      };
      bool before = false;
      bool behind = false;
      for (int n = 1; n <= reach; ++n) {
        before = before || near(k - n);
        behind = behind || near(k + n);
      }
      if (before && behind) at(k) = -1;
    }
  }
}

void golden_support_list(Size grid_size, int step, std::span<const std::int16_t> grid,
                         std::span<std::int16_t> list, std::span<std::uint32_t> count) {
  std::size_t n = 0;
  for (int j = 0; j < grid_size.height; ++j) {
    for (int i = 0; i < grid_size.width; ++i) {
      const std::int16_t d = grid[static_cast<std::size_t>(j * grid_size.width + i)];
      if (d < 0) continue;
      list[4 * n] = static_cast<std::int16_t>(i * step);
      list[4 * n + 1] = static_cast<std::int16_t>(j * step);
      list[4 * n + 2] = d;
      list[4 * n + 3] = 0;
      ++n;
    }
  }
  count[0] = static_cast<std::uint32_t>(n);
}

}  // namespace partita::depth
