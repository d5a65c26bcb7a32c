// What `partita explore` was asked, and what came of it; see explore_command.cpp for the order of
// things.
#ifndef PARTITA_HOST_APP_EXPLORE_H
#define PARTITA_HOST_APP_EXPLORE_H

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/app/console.h"
#include "host/app/run_counts.h"
#include "partition/search/search.h"

namespace partita::app {

struct ExploreOptions {
  std::vector<std::string> machines{"dragonfly"};  ///< names or files; "all": every one there is
  std::string pipeline = "dragonfly";
  std::string objective = "latency";
  std::vector<std::string> pins, limits;
  std::size_t frames = 100;
  std::string from;         ///< folder of an earlier run; empty: run the scenario
  bool no_execute = false;  ///< typical counts, without a run and without OpenCL
  bool allow_swap = false;
  std::string areas;  ///< file of declared areas; empty: our own estimates
  partition::Vehicle vehicle;
  std::string out = "partita-explore";
  bool force = false;
};

inline constexpr const char* kExploreFile = "explore.json";
/// More make a trace that no viewer opens, and a record that does not fit the memory.
inline constexpr std::size_t kScheduleFrames = 100;

/// Everything that the answers are made of.
struct ExploreReport {
  const ExploreOptions& options;
  partition::Pipeline pipeline;
  partition::Workload workload;
  std::optional<RunCounts> counts;  ///< that the workload was made of
  std::vector<profile::Machine> machines;
  std::vector<std::unique_ptr<partition::Evaluator>> evaluators;  ///< one per machine
  partition::Exploration exploration;
  /// Of the first in the ranking, with its schedule, for kScheduleFrames frames at most.
  std::optional<partition::Reference> best;
  std::size_t scheduled_frames = 0;
  std::vector<std::string> files;

  bool partial() const;
  /// Of the first in the ranking.
  const partition::MachineResult& winner() const {
    return exploration.machines[exploration.ranking.front().machine];
  }
  const partition::Evaluator& evaluator(const partition::MachineResult& result) const {
    return *evaluators[result.evaluator];
  }
  const profile::Machine& machine(const partition::MachineResult& result) const {
    return machines[result.evaluator];
  }
  const std::string& place(const partition::MachineResult& result,
                           const partition::TaskPlacement& placement, std::uint32_t task) const {
    return evaluator(result).places(task)[placement[task]].name;
  }
};

/// Sets pipeline, counts and workload as the options say; runs the scenario where they ask for it.
/// The pipeline's pictures become those of the run. `check_early` is called with the pipeline
/// before anything runs that takes long.
void prepare_workload(ExploreReport& report, const Console& console,
                      const std::function<void(const partition::Pipeline&)>& check_early);

/// The content of explore.json. No figure in it is measured; the same inputs give the same bytes.
Json to_json(const ExploreReport& report);
/// The same for people.
std::string to_text(const ExploreReport& report, const Console& console);
/// explore.csv: a line for each placement of the machines' fronts.
std::string to_csv(const ExploreReport& report);

/// NAME.svg and NAME.png in the folder: all placements, latency against energy.
void write_pareto_plot(const std::string& folder, const ExploreReport& report);
/// The same: some frames of the best placement's schedule, a lane for each engine.
void write_schedule_plot(const std::string& folder, const ExploreReport& report);
/// trace.json: the same for all of report.scheduled_frames.
void write_schedule_trace(const std::string& path, const ExploreReport& report);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_EXPLORE_H
