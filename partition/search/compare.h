// Comparison: whether one placement is better than another beyond what the predictions' uncertainty
// explains.
//
// A profile's uncertainty u says that its device really takes 1 - u to 1 + u times the predicted
// time. That error is common to everything that runs on parts of that profile, in both placements
// and on both machines, so it mostly cancels where both use the part. Therefore it is the
// difference that gets an interval: both placements are simulated again with parts slower by 1 + u
// and faster by 1 / (1 - u), and A beats B only if it does so every time.
//
// Which corners: times grow when a part gets slower, so of the parts that only A uses the worst
// corner is "slow", of those that only B uses "fast". Parts that both use may matter either way:
// all combinations of slow and fast for up to four of them; of more, each alone, all slow and all
// fast.
#ifndef PARTITA_PARTITION_SEARCH_COMPARE_H
#define PARTITA_PARTITION_SEARCH_COMPARE_H

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "partition/search/evaluator.h"
#include "partition/search/objective.h"

namespace partita::partition {

/// Something whose speed is uncertain, or is asked about.
struct Part {
  std::string name;        ///< a profile's id or a link's name
  double uncertainty = 0;  ///< relative, of times
  bool assumed = false;    ///< the file states none: the default
  bool operator==(const Part&) const = default;
};

/// Parts that the placement uses: profiles of its devices and of the CPUs of their nodes, networks.
std::vector<Part> parts(const Evaluator& evaluator, const TaskPlacement& placement);

struct Comparison {
  bool beats =
      false;  ///< else they tie; what drops less work in every corner beats, see objective.h
  /// What decided: the objective, or, where that is the same in every corner, the latency.
  Objective by = Objective::latency;
  double nominal = 0;          ///< value of B minus value of A, as predicted
  double least = 0, most = 0;  ///< of that difference over all corners
  std::size_t corners = 0;
  double dropped = 0;  ///< share that B drops minus that of A, as predicted
};

/// Evaluates with changed speeds and remembers. Not thread-safe.
class Comparer {
 public:
  explicit Comparer(Objective objective) : objective_(objective) {}

  /// Whether `a` beats `b`; the two may be on different machines.
  Comparison compare(const Evaluator& on_a, const TaskPlacement& a, const Evaluator& on_b,
                     const TaskPlacement& b);

 private:
  using Corner = std::map<std::string, double>;  ///< speed by part; others as declared
  const Score& score(const Evaluator& on, const TaskPlacement& placement, const Corner& corner);

  struct Scaled {
    std::unique_ptr<Evaluator> evaluator;
    std::map<TaskPlacement, Score> scores;
  };
  Objective objective_;
  std::map<std::pair<const Evaluator*, Corner>, Scaled> scaled_;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_COMPARE_H
