// Why a placement is as good as it is, and what would make it better.
#ifndef PARTITA_PARTITION_SEARCH_EXPLAIN_H
#define PARTITA_PARTITION_SEARCH_EXPLAIN_H

#include <string>
#include <vector>

#include "partition/search/evaluator.h"
#include "partition/search/objective.h"

namespace partita::partition {

/// A task on the critical path; means over frames. waited + duration add up to the latency.
struct PathStep {
  std::string task, place;
  double waited_ns = 0;    ///< after the step before (the trigger): for transfers, its turn, others
  double duration_ns = 0;  ///< start to end
  double alone_ns = 0;     ///< the same with no other task on the machine: the rest is contention
};

/// What one thing, twice as fast, would change, with everything staying where it is.
struct Sensitivity {
  std::string what;  ///< "gtx1060", "bus of gtx1060", "pc/i5-8500", "ethernet"
  double speed = 2;
  Score score;  ///< then
  /// Of the objective (where that is the cost, of the latency), in its unit; above 0: better.
  double gain = 0;
  double relative_gain = 0;  ///< share of the value
};

struct Explanation {
  std::vector<PathStep> critical_path;  ///< first task first
  std::string busiest_engine;
  double busiest_share = 0;                ///< of the makespan
  std::vector<Sensitivity> sensitivities;  ///< largest gain first
  /// The same in sentences, one line each, for people.
  std::vector<std::string> lines;
};

/// `figures` are evaluate()'s, `score` the placement's.
Explanation explain(const Evaluator& evaluator, const TaskPlacement& placement,
                    const Figures& figures, const Score& score, Objective objective);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_EXPLAIN_H
