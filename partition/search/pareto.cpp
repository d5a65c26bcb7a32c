#include "partition/search/pareto.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace partita::partition {
namespace {

using Point = std::array<double, 7>;

/// Less is better in each.
Point point(const Score& s) {
  return {s.p50_ns, s.p99_ns, s.energy_j, s.frame_ns, s.area, s.price_usd, s.dropped};
}

bool no_worse(const Point& a, const Point& b) {
  return std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return x <= y; });
}

}  // namespace

bool dominates(const Score& a, const Score& b) {
  const Point p = point(a), q = point(b);
  return no_worse(p, q) && p != q;
}

std::vector<std::size_t> pareto_front(const std::vector<Score>& scores) {
  std::vector<Point> points;
  points.reserve(scores.size());
  for (const Score& score : scores) points.push_back(point(score));
  // In lexicographic order nothing is dominated by what comes later, so that what is once in the
  // front stays in it.
  std::vector<std::size_t> order(scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a] != points[b] ? points[a] < points[b] : a < b;
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order) {
    const bool dominated = std::any_of(front.begin(), front.end(), [&](std::size_t f) {
      return no_worse(points[f], points[i]) && points[f] != points[i];
    });
    if (!dominated) front.push_back(i);
  }
  std::sort(front.begin(), front.end());
  return front;
}

}  // namespace partita::partition
