#include <algorithm>
#include <limits>

#include "partition/search/strategies.h"

namespace partita::partition {
namespace {

/// Depth first, the most promising place of each task first. Whole placements are collected and
/// evaluated together; the batch's size is fixed, so that the result does not depend on threads.
class Branching {
 public:
  Branching(Explored& explored, std::uint64_t bounds)
      : explored_(explored), placement_(explored.choices().size(), kOpen), left_(bounds) {}

  double run() {
    const Bounds root = explored_.bounder().root();
    branch(0, root);
    flush();
    return left_out_;
  }

 private:
  static constexpr std::size_t kBatch = 64;

  struct Child {
    std::uint32_t place = 0;
    Bounds bounds;
  };

  bool over() const { return left_ == 0 || explored_.exhausted(); }

  void leave_out(const Bounds& bounds) {
    left_out_ = std::min(left_out_, bounds.cost(explored_.options().objective));
  }

  /// Nothing below it is within the limits, or ranks before the best.
  bool hopeless(const Bounds& bounds) const {
    const Score least = bounds.score();
    if (!explored_.options().limits.met(least)) return true;
    if (explored_.best() == Explored::kNone) return false;
    const Score& best = explored_.points()[explored_.best()].score;
    return ranks_before(explored_.options().objective, best, least);
  }

  void branch(std::size_t task, const Bounds& bounds) {
    if (over()) return leave_out(bounds);
    if (hopeless(bounds)) return;
    if (task == placement_.size()) return collect(bounds);
    const Objective objective = explored_.options().objective;
    std::vector<Child> children;
    for (const std::uint32_t place : explored_.choices()[task]) {
      placement_[task] = place;
      children.push_back({place, explored_.bounder()(placement_)});
      left_ -= left_ > 0 ? 1 : 0;
    }
    std::stable_sort(children.begin(), children.end(), [&](const Child& a, const Child& b) {
      return ranks_before(objective, a.bounds.score(), b.bounds.score());
    });
    for (const Child& child : children) {
      placement_[task] = child.place;
      branch(task + 1, child.bounds);
    }
    placement_[task] = kOpen;
  }

  void collect(const Bounds& bounds) {
    batch_.push_back(placement_);
    bounds_.push_back(bounds);
    if (batch_.size() == kBatch) flush();
  }

  void flush() {
    if (explored_.stopped()) {
      for (const Bounds& bounds : bounds_) leave_out(bounds);
    } else {
      explored_.look_at(batch_);
    }
    batch_.clear();
    bounds_.clear();
  }

  Explored& explored_;
  TaskPlacement placement_;
  std::uint64_t left_;
  std::vector<TaskPlacement> batch_;
  std::vector<Bounds> bounds_;
  double left_out_ = std::numeric_limits<double>::infinity();
};

}  // namespace

double branch_and_bound(Explored& explored, std::uint64_t bounds) {
  return Branching(explored, bounds).run();
}

}  // namespace partita::partition
