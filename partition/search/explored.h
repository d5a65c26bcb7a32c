// Explored: the placements of one machine that a search has looked at, what they scored, and why
// others cannot be. Inside the partition library only.
#ifndef PARTITA_PARTITION_SEARCH_EXPLORED_H
#define PARTITA_PARTITION_SEARCH_EXPLORED_H

#include <map>
#include <span>
#include <string>
#include <vector>

#include "partition/search/bound.h"
#include "partition/search/search.h"

namespace partita::partition {

class Explored {
 public:
  static constexpr std::size_t kNone = ~std::size_t{0};

  Explored(const Evaluator& evaluator, const SearchOptions& options, std::uint64_t budget);

  struct Point {
    TaskPlacement placement;
    Score score;
  };

  /// Looks at those that are new, on all threads; what comes of it does not depend on their number.
  /// Returns how many were evaluated.
  std::size_t look_at(std::span<const TaskPlacement> placements);

  const std::vector<Point>& points() const { return points_; }
  /// Index of an evaluated placement; kNone if it is infeasible or was not looked at.
  std::size_t find(const TaskPlacement& placement) const;
  /// Best of those within the limits; kNone: there is none.
  std::size_t best() const { return best_; }
  /// `a` is better than `b`: within the limits or less beyond them; by rank; by placement order.
  bool better(std::size_t a, std::size_t b) const;

  bool stopped() const { return stopped_; }
  bool exhausted() const { return stopped_ || points_.size() >= budget_; }
  std::uint64_t infeasible() const { return infeasible_; }
  std::vector<Refusal> refusals() const;

  const Evaluator& evaluator() const { return evaluator_; }
  const SearchOptions& options() const { return options_; }
  const Choices& choices() const { return choices_; }
  /// Of any placement, and of those under which nothing is dropped.
  const Bounder& bounder(Drops drops) const { return drops == Drops::none ? complete_ : any_; }
  /// Bounds of the placements that may still rank before the best.
  const Bounder& bounder() const {
    const bool complete = best_ != kNone && points_[best_].score.dropped == 0;
    return bounder(complete ? Drops::none : Drops::possible);
  }

 private:
  struct Look {
    std::string refusal;
    Score score;
  };
  Look look(const TaskPlacement& placement) const;
  void refuse(const std::string& reason, const TaskPlacement& placement);

  const Evaluator& evaluator_;
  const SearchOptions& options_;
  const Choices choices_;
  const Bounder any_, complete_;
  const std::uint64_t budget_;
  const unsigned threads_;
  std::vector<Point> points_;
  std::map<TaskPlacement, std::size_t> index_;  ///< into points_; kNone: infeasible
  std::map<std::string, std::size_t> reasons_;  ///< into refusals_
  std::vector<Refusal> refusals_;               ///< in the order found
  std::uint64_t infeasible_ = 0;
  std::size_t best_ = kNone;
  bool stopped_ = false;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_EXPLORED_H
