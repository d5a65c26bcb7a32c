// The search: which placement is best, how good any could be, what else is worth a look, and why.
//
// Up to SearchOptions::enumerate placements, all of them are simulated: the best is the optimum
// under the simulator's arbitration, the front is exact. Beyond, a local search from a greedy
// placement finds a good one, and branch and bound proves it, or finds the optimum, as far as the
// budget lasts; then the result says how far from the bound it is. The same inputs give the same
// result on any number of threads; what ranks equal keeps the placements' order.
#ifndef PARTITA_PARTITION_SEARCH_SEARCH_H
#define PARTITA_PARTITION_SEARCH_SEARCH_H

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "partition/search/compare.h"
#include "partition/search/evaluator.h"
#include "partition/search/explain.h"
#include "partition/search/limits.h"
#include "partition/search/objective.h"
#include "partition/search/pins.h"
#include "partition/search/vehicle.h"

namespace partita::partition {

struct Progress {
  std::string machine;
  std::uint64_t evaluated = 0;
  std::uint64_t budget = 0;  ///< at most so many; branch and bound may be done earlier
};

struct SearchOptions {
  Objective objective = Objective::latency;
  std::vector<Pin> pins;
  Limits limits;
  Vehicle vehicle;
  std::uint64_t enumerate = 20'000;  ///< simulate all placements if there are no more than that
  std::uint64_t budget = 20'000;     ///< placements to simulate otherwise
  std::uint64_t bound_budget =
      20'000'000;                   ///< partial placements that branch and bound may look at
  std::size_t tie_candidates = 20;  ///< how many of the next best are compared with the best
  unsigned threads = 0;             ///< 0: as many as the hardware has
  /// Called now and then by the thread that called explore(); false stops the search, and what was
  /// found so far is the result.
  std::function<bool(const Progress&)> progress;
};

/// Placements that cannot be, by reason.
struct Refusal {
  std::string reason;  ///< "does not fit zcu102: BRAM36 1,020 of 912 needed by …"
  std::uint64_t count = 0;
  std::string example;  ///< the first such placement
};

struct Scored {
  TaskPlacement placement;
  std::string name;  ///< "frontend=zcu102,depth=gtx1060,…"
  Score score;
};

struct FpgaArea {
  std::string device;
  profile::Area used, available;
};

struct Detailed : Scored {
  Figures figures;
  std::vector<FpgaArea> areas;  ///< of the FPGAs in use
  double added_stopping_m = 0;  ///< at the vehicle's speed and latency p99
  double driving_hours = 0;
};

/// A placement that is not the best one, and how sure that is.
struct Rival : Detailed {
  Comparison comparison;             ///< A: the best; B: this one
  std::vector<std::string> changes;  ///< "depth: gtx1060 -> i5-8500"
};

enum class Method : std::uint8_t {
  enumeration,       ///< every placement was simulated
  branch_and_bound,  ///< every placement was simulated or cannot be better
  local_search,      ///< neither; the bound says how much better others could be
};
std::string_view to_string(Method method);

struct MachineResult {
  std::string machine, hash;
  std::size_t evaluator = 0;     ///< index into explore()'s evaluators
  std::uint64_t placements = 0;  ///< that the pins leave, feasible or not
  std::uint64_t evaluated = 0;
  std::uint64_t infeasible = 0;     ///< of those looked at
  std::uint64_t beyond_limits = 0;  ///< of those evaluated
  std::vector<Refusal> refusals;    ///< most frequent first
  /// Not empty: no placement of this machine is feasible and within the limits; one line says the
  /// least that can be reached, and how. Then there is no best.
  std::string unreachable;

  std::optional<Detailed> best;
  std::optional<Rival> next;  ///< the second in rank, of those evaluated
  /// That the best does not beat beyond uncertainty, in rank; of those that drop as much work.
  std::vector<Rival> ties;
  bool all_ties = true;  ///< false: there may be more, tie_candidates were compared
  /// Non-dominated placements within the limits, by latency p99.
  std::vector<Scored> front;
  bool exact_front = false;      ///< of all placements; else of those evaluated
  std::vector<Score> dominated;  ///< of the others within the limits, best first

  Method method = Method::enumeration;
  bool optimal = false;
  bool stopped = false;  ///< by the progress callback
  /// What no placement that drops as little can beat, in the objective's unit: of throughput an
  /// upper bound. Equal to the best's value if optimal.
  double bound = 0;
  double gap = 0;  ///< relative distance of the best to the bound, 0 if optimal
  /// Of the whole space, without search, where no frame is dropped.
  double path_bound_ns = 0, load_bound_ns = 0;
  Explanation explanation;  ///< of the best
  std::vector<Part> parts;  ///< that the best uses, with their uncertainties
};

/// A place in the ranking over machines.
struct Ranked {
  std::size_t machine = 0;  ///< index into Exploration::machines
  Comparison behind;        ///< A: the first of the ranking; of the first itself: zero
  bool tie = false;         ///< with the first
};

struct FrontPoint {
  std::size_t machine = 0;  ///< index into Exploration::machines
  std::size_t point = 0;    ///< index into its front
};

struct Exploration {
  SearchOptions options;  ///< as given, without the callback
  std::string pipeline, pipeline_hash;
  std::vector<MachineResult> machines;  ///< as given
  std::vector<Ranked> ranking;          ///< machines with a best, best first
  std::vector<FrontPoint> front;        ///< across machines, by latency p99
};

/// "the next best costs 12.40 ms (8 %) more: depth: gtx1060 -> i5-8500", or that the two tie.
std::string describe(const Rival& rival, Objective objective);

/// `evaluators`: one per machine, of one pipeline and workload. Throws profile::Error for pins and
/// limits that no machine satisfies, and for figures that are physically impossible;
/// std::logic_error if a bound exceeds a value found, which is a bug.
Exploration explore(const std::vector<const Evaluator*>& evaluators, const SearchOptions& options);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_SEARCH_H
