#include <algorithm>
#include <random>

#include "partition/search/strategies.h"

namespace partita::partition {
namespace {

class Descent {
 public:
  Descent(Explored& explored, std::uint64_t evaluations)
      : explored_(explored), choices_(explored.choices()), left_(evaluations) {}

  void run() {
    look_at(seeds());
    std::size_t best = best_point();
    if (best == Explored::kNone) return;
    best = downhill(best);
    constexpr int kPatience = 12;
    for (int fruitless = 0; fruitless < kPatience && !spent(); ++fruitless) {
      const TaskPlacement start = kicked(explored_.points()[best].placement);
      look_at({start});
      const std::size_t from = explored_.find(start);
      if (from == Explored::kNone) continue;
      const std::size_t to = downhill(from);
      if (!explored_.better(to, best)) continue;
      best = to;
      fruitless = -1;
    }
  }

 private:
  bool spent() const { return left_ == 0 || explored_.exhausted(); }

  void look_at(const std::vector<TaskPlacement>& placements) {
    left_ -= std::min<std::uint64_t>(left_, explored_.look_at(placements));
  }

  std::size_t best_point() const {
    std::size_t best = Explored::kNone;
    for (std::size_t i = 0; i < explored_.points().size(); ++i) {
      if (best == Explored::kNone || explored_.better(i, best)) best = i;
    }
    return best;
  }

  /// The greedy placement by bounds; everything on the first, second … place it has; and random
  /// ones, since of the others none may be feasible.
  std::vector<TaskPlacement> seeds() {
    TaskPlacement greedy(choices_.size(), kOpen);
    for (std::size_t t = 0; t < greedy.size(); ++t) {
      double least = std::numeric_limits<double>::infinity();
      std::uint32_t chosen = choices_[t].front();
      for (const std::uint32_t place : choices_[t]) {
        greedy[t] = place;
        const double cost =
            explored_.bounder(Drops::none)(greedy).cost(explored_.options().objective);
        if (cost < least) {
          least = cost;
          chosen = place;
        }
      }
      greedy[t] = chosen;
    }
    std::vector<TaskPlacement> seeds{greedy};
    std::size_t most = 0;
    for (const auto& places : choices_) most = std::max(most, places.size());
    for (std::size_t i = 0; i < most; ++i) {
      TaskPlacement& same = seeds.emplace_back();
      for (const auto& places : choices_) same.push_back(places[std::min(i, places.size() - 1)]);
    }
    constexpr int kRandomSeeds = 32;
    for (int i = 0; i < kRandomSeeds; ++i) {
      TaskPlacement& any = seeds.emplace_back();
      for (const auto& places : choices_) any.push_back(places[draw(places.size())]);
    }
    return seeds;
  }

  /// Every placement that differs in one task, or in exactly two.
  std::vector<TaskPlacement> neighbours(const TaskPlacement& of, bool two) const {
    std::vector<TaskPlacement> result;
    TaskPlacement changed = of;
    for (std::size_t a = 0; a < of.size(); ++a) {
      for (const std::uint32_t place_a : choices_[a]) {
        if (place_a == of[a]) continue;
        changed[a] = place_a;
        if (!two) result.push_back(changed);
        for (std::size_t b = a + 1; two && b < of.size(); ++b) {
          for (const std::uint32_t place_b : choices_[b]) {
            if (place_b == of[b]) continue;
            changed[b] = place_b;
            result.push_back(changed);
          }
          changed[b] = of[b];
        }
      }
      changed[a] = of[a];
    }
    return result;
  }

  /// To the best neighbour, as long as it is better; two tasks at a time where one does not help.
  std::size_t downhill(std::size_t at) {
    while (!spent()) {
      std::size_t next = at;
      for (const bool two : {false, true}) {
        const auto around = neighbours(explored_.points()[at].placement, two);
        // In parts, so that the budget is kept to about one of them.
        constexpr std::size_t kPart = 256;
        for (std::size_t i = 0; i < around.size() && !spent(); i += kPart) {
          look_at(
              {around.begin() + static_cast<std::ptrdiff_t>(i),
               around.begin() + static_cast<std::ptrdiff_t>(std::min(around.size(), i + kPart))});
        }
        for (const TaskPlacement& placement : around) {
          const std::size_t point = explored_.find(placement);
          if (point != Explored::kNone && explored_.better(point, next)) next = point;
        }
        if (next != at) break;
      }
      if (next == at) break;
      at = next;
    }
    return at;
  }

  /// With three tasks somewhere else.
  TaskPlacement kicked(TaskPlacement placement) {
    for (int i = 0; i < 3; ++i) {
      const std::size_t t = draw(placement.size());
      placement[t] = choices_[t][draw(choices_[t].size())];
    }
    return placement;
  }

  /// Not a std distribution: those differ between libraries.
  std::size_t draw(std::size_t below) { return random_() % below; }

  Explored& explored_;
  const Choices& choices_;
  std::uint64_t left_;
  std::mt19937_64 random_{1};
};

}  // namespace

void local_search(Explored& explored, std::uint64_t evaluations) {
  Descent(explored, evaluations).run();
}

}  // namespace partita::partition
