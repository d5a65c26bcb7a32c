#include "partition/search/search.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "partition/search/machine_search.h"
#include "partition/search/pareto.h"
#include "partition/text.h"

namespace partita::partition {
namespace {

/// Results of all machines; one that cannot satisfy the pins says so and does not end the others.
void search_machines(const std::vector<const Evaluator*>& evaluators, const SearchOptions& options,
                     Comparer& comparer, Exploration& exploration) {
  std::size_t with_best = 0;
  std::string why;
  for (std::size_t i = 0; i < evaluators.size(); ++i) {
    MachineResult result;
    try {
      result = search_machine(*evaluators[i], options, comparer);
    } catch (const PinError& error) {
      result.machine = evaluators[i]->machine().id;
      result.hash = evaluators[i]->machine().content_hash;
      result.unreachable = error.what();
    }
    result.evaluator = i;
    with_best += result.best ? 1 : 0;
    if (!result.unreachable.empty()) why += (why.empty() ? "" : "; ") + result.unreachable;
    exploration.machines.push_back(std::move(result));
  }
  if (with_best == 0) throw profile::Error(why);
}

void rank_machines(const std::vector<const Evaluator*>& evaluators, Comparer& comparer,
                   Exploration& exploration) {
  const std::vector<MachineResult>& machines = exploration.machines;
  for (std::size_t i = 0; i < machines.size(); ++i) {
    if (machines[i].best) exploration.ranking.push_back({i, {}, false});
  }
  std::stable_sort(exploration.ranking.begin(), exploration.ranking.end(),
                   [&](const Ranked& a, const Ranked& b) {
                     return ranks_before(exploration.options.objective,
                                         machines[a.machine].best->score,
                                         machines[b.machine].best->score);
                   });
  const std::size_t first = exploration.ranking.front().machine;
  for (std::size_t i = 1; i < exploration.ranking.size(); ++i) {
    Ranked& other = exploration.ranking[i];
    other.behind =
        comparer.compare(*evaluators[first], machines[first].best->placement,
                         *evaluators[other.machine], machines[other.machine].best->placement);
    other.tie = !other.behind.beats;
  }
}

void join_fronts(Exploration& exploration) {
  std::vector<FrontPoint> points;
  std::vector<Score> scores;
  for (std::size_t m = 0; m < exploration.machines.size(); ++m) {
    for (std::size_t p = 0; p < exploration.machines[m].front.size(); ++p) {
      points.push_back({m, p});
      scores.push_back(exploration.machines[m].front[p].score);
    }
  }
  std::vector<std::size_t> front = pareto_front(scores);
  std::stable_sort(front.begin(), front.end(), [&](std::size_t a, std::size_t b) {
    return ranks_before(Objective::latency, scores[a], scores[b]);
  });
  for (const std::size_t i : front) exploration.front.push_back(points[i]);
}

}  // namespace

std::string_view to_string(Method method) {
  switch (method) {
    case Method::enumeration:
      return "enumeration";
    case Method::branch_and_bound:
      return "branch and bound";
    case Method::local_search:
      return "local search";
  }
  return "?";
}

std::string describe(const Rival& rival, Objective objective) {
  const Comparison& c = rival.comparison;
  std::string changes;
  for (const std::string& change : rival.changes) append(changes, change);
  if (c.nominal == 0 && c.least == 0 && c.most == 0 && c.dropped == 0) {
    return "the next best has exactly the same " + std::string(to_string(c.by)) + " (" + changes +
           "): a tie";
  }
  std::string text = c.beats ? "the next best " : "a tie with the next best, which ";
  if (c.by != objective) {
    text += "has the same " + std::string(to_string(objective)) + " and ";
  }
  const auto than_best = [](double difference) { return difference < 0 ? " less" : " more"; };
  if (c.dropped != 0) {
    char share[32];
    std::snprintf(share, sizeof share, "%.1f %%", 100 * std::abs(c.dropped));
    text.append("drops ").append(share).append(than_best(c.dropped)).append(" of the work and ");
  }
  text.append(c.by == Objective::throughput ? "does " : "takes ")
      .append(show(c.by, std::abs(c.nominal)))
      .append(than_best(c.nominal))
      .append(" (" + changes + ")");
  if (!c.beats && c.dropped != 0) {
    return text + ": within the uncertainty, which of the two drops more";
  }
  if (!c.beats) {
    return text + ": with the uncertainty, from " + show(c.by, c.least) + " to " +
           show(c.by, c.most);
  }
  if (c.dropped != 0) return text;
  const double smallest = std::min(std::abs(c.least), std::abs(c.most));
  return text + ", in every corner of the uncertainty at least " + show(c.by, smallest);
}

Exploration explore(const std::vector<const Evaluator*>& evaluators, const SearchOptions& options) {
  if (evaluators.empty()) throw profile::Error("explore: no machine, expected at least one");
  check(options.vehicle);
  Exploration exploration;
  exploration.options = options;
  exploration.options.progress = nullptr;
  exploration.pipeline = evaluators.front()->pipeline().id;
  exploration.pipeline_hash = evaluators.front()->pipeline().content_hash;
  Comparer comparer(options.objective);
  search_machines(evaluators, options, comparer, exploration);
  rank_machines(evaluators, comparer, exploration);
  join_fronts(exploration);
  return exploration;
}

}  // namespace partita::partition
