#include "partition/search/machine_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "partition/search/pareto.h"
#include "partition/search/sanity.h"
#include "partition/search/strategies.h"
#include "partition/text.h"

namespace partita::partition {
namespace {

using Point = Explored::Point;

/// Sets method, bound (as a cost()) and whether the best is proven.
void search(Explored& explored, MachineResult& result) {
  const SearchOptions& options = explored.options();
  const Objective objective = options.objective;
  double left_out = std::numeric_limits<double>::infinity();
  if (result.placements <= options.enumerate) {
    enumerate(explored);
    result.method = Method::enumeration;
    if (explored.stopped()) left_out = explored.bounder().root().cost(objective);
  } else {
    // The better the first placement, the more is pruned; half of the budget is left to prove it.
    local_search(explored, options.budget / 2);
    left_out = branch_and_bound(explored, options.bound_budget);
    result.method = std::isinf(left_out) ? Method::branch_and_bound : Method::local_search;
  }
  result.stopped = explored.stopped();
  result.bound = left_out;
  if (explored.best() == Explored::kNone) return;
  const double best = cost(objective, explored.points()[explored.best()].score);
  // What drops nothing ranks before what drops something, whatever else it takes.
  const bool complete = explored.points()[explored.best()].score.dropped == 0;
  result.optimal = std::isinf(left_out) || (complete && left_out >= best);
  result.bound = std::min(left_out, best);
  result.gap = result.optimal ? 0 : best / result.bound - 1;
}

/// A bound that a placement beats is wrong, and so is everything that was pruned by it.
void check_bound(const Explored& explored, Drops drops) {
  constexpr double kSlack = 1 + 1e-9;
  const Bounds root = explored.bounder(drops).root();
  for (const Objective objective : kObjectives) {
    for (const Point& point : explored.points()) {
      if (drops == Drops::none && point.score.dropped > 0) continue;
      if (root.cost(objective) <= cost(objective, point.score) * kSlack) continue;
      throw std::logic_error("bound of " +
                             show(objective, convert(objective, root.cost(objective))) +
                             " is beaten by " + explored.evaluator().name(point.placement) +
                             " with " + show(objective, value(objective, point.score)));
    }
  }
}

/// Points within the limits, best first.
std::vector<std::size_t> ranked(const Explored& explored) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < explored.points().size(); ++i) {
    if (explored.options().limits.met(explored.points()[i].score)) order.push_back(i);
  }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return explored.better(a, b); });
  return order;
}

Scored scored(const Evaluator& evaluator, const Point& point) {
  return {point.placement, evaluator.name(point.placement), point.score};
}

Detailed detailed(const Explored& explored, const Point& point) {
  const Evaluator& evaluator = explored.evaluator();
  const Vehicle& vehicle = explored.options().vehicle;
  Detailed result{scored(evaluator, point), evaluator.evaluate(point.placement), {}, 0, 0};
  check_plausible(evaluator, point.placement, result.figures,
                  explored.bounder(drops_of(result.figures))(point.placement));
  const auto& devices = evaluator.machine().devices;
  for (std::uint32_t d = 0; d < devices.size(); ++d) {
    const profile::Area used = evaluator.area(point.placement, d);
    if (devices[d].profile.type != profile::DeviceType::fpga || used == profile::Area{}) continue;
    result.areas.push_back({devices[d].name, used, devices[d].profile.fabric.area});
  }
  result.added_stopping_m = added_stopping_distance_m(vehicle, point.score.p99_ns);
  result.driving_hours = driving_hours(vehicle, point.score.power_w);
  return result;
}

Rival rival(const Explored& explored, const Point& best, const Point& other, Comparer& comparer) {
  const Evaluator& evaluator = explored.evaluator();
  Rival result;
  static_cast<Detailed&>(result) = detailed(explored, other);
  result.comparison = comparer.compare(evaluator, best.placement, evaluator, other.placement);
  for (std::uint32_t t = 0; t < best.placement.size(); ++t) {
    if (best.placement[t] == other.placement[t]) continue;
    const auto& places = evaluator.places(t);
    result.changes.push_back(evaluator.pipeline().tasks[t].name + ": " +
                             places[best.placement[t]].name + " -> " +
                             places[other.placement[t]].name);
  }
  return result;
}

/// Whether uncertainty could make up for the difference: no time changes by more than the largest
/// uncertainty of all parts.
bool may_tie(const Evaluator& evaluator, Objective objective, const Score& best,
             const Score& other) {
  if (best.dropped != other.dropped) return false;
  double most = 0;
  for (const auto& device : evaluator.machine().devices) {
    most = std::max(most, profile::uncertainty(device.profile));
  }
  for (const auto& node : evaluator.machine().nodes) {
    most = std::max(most, profile::uncertainty(node.host));
  }
  for (const auto& link : evaluator.machine().links) {
    most = std::max(most, link.uncertainty.value_or(profile::kDefaultUncertainty));
  }
  if (objective == Objective::cost) {
    if (best.price_usd != other.price_usd) return false;
    objective = Objective::latency;
  }
  return cost(objective, other) * (1 - most) <= cost(objective, best) * (1 + most);
}

void add_rivals(const Explored& explored, const std::vector<std::size_t>& order, Comparer& comparer,
                MachineResult& result) {
  const SearchOptions& options = explored.options();
  const Point& best = explored.points()[order.front()];
  for (std::size_t i = 1; i < order.size(); ++i) {
    const Point& other = explored.points()[order[i]];
    const bool near = may_tie(explored.evaluator(), options.objective, best.score, other.score);
    if (i > 1 && !near) break;
    if (i > 1 && i > options.tie_candidates) {
      result.all_ties = false;
      break;
    }
    const Rival found = rival(explored, best, other, comparer);
    if (i == 1) result.next = found;
    if (!found.comparison.beats) result.ties.push_back(found);
  }
}

void add_front(const Explored& explored, const std::vector<std::size_t>& order,
               MachineResult& result) {
  std::vector<Score> scores;
  for (const std::size_t i : order) scores.push_back(explored.points()[i].score);
  std::vector<std::size_t> front;
  const std::vector<std::size_t> best = pareto_front(scores);
  for (std::size_t i = 0, next = 0; i < order.size(); ++i) {
    if (next < best.size() && best[next] == i) {
      front.push_back(order[i]);
      ++next;
    } else {
      result.dominated.push_back(scores[i]);
    }
  }
  std::sort(front.begin(), front.end(), [&](std::size_t a, std::size_t b) {
    const Point &p = explored.points()[a], &q = explored.points()[b];
    if (ranks_before(Objective::latency, p.score, q.score)) return true;
    return !ranks_before(Objective::latency, q.score, p.score) && p.placement < q.placement;
  });
  for (const std::size_t i : front) {
    result.front.push_back(scored(explored.evaluator(), explored.points()[i]));
  }
  result.exact_front = result.method == Method::enumeration && !result.stopped;
}

/// The placement with least of what is limited.
const Point& least(const Explored& explored, Limited what) {
  return *std::min_element(explored.points().begin(), explored.points().end(),
                           [&](const Point& a, const Point& b) {
                             const double x = figure(what, a.score), y = figure(what, b.score);
                             return x != y ? x < y : a.placement < b.placement;
                           });
}

std::string why_unreachable(const Explored& explored, const MachineResult& result) {
  const Evaluator& evaluator = explored.evaluator();
  const std::string machine = "machine '" + result.machine + "': ";
  if (explored.points().empty()) {
    const std::string reason =
        result.refusals.empty() ? "the search was stopped" : result.refusals.front().reason;
    return machine + "no placement is feasible: " + reason;
  }
  const Limits& limits = explored.options().limits;
  const bool all = result.method == Method::enumeration && !result.stopped;
  const std::string of = all ? "the least is " : "the least found is ";
  for (const Limited what : kLimited) {
    const Point& point = least(explored, what);
    if (!limits[what] || figure(what, point.score) <= *limits[what]) continue;
    return machine + "no placement meets " + std::string(to_string(what)) + "=" +
           show(what, *limits[what]) + ", " + of + show(what, figure(what, point.score)) + " by " +
           evaluator.name(point.placement);
  }
  const auto closest = std::min_element(
      explored.points().begin(), explored.points().end(), [&](const Point& a, const Point& b) {
        const double x = limits.excess(a.score), y = limits.excess(b.score);
        return x != y ? x < y : a.placement < b.placement;
      });
  std::string figures;
  for (const Limited what : kLimited) {
    if (!limits[what]) continue;
    append(figures, std::string(to_string(what)) + " " + show(what, figure(what, closest->score)));
  }
  return machine + "no placement meets " + limits.to_string() + " together, the closest has " +
         figures + " by " + evaluator.name(closest->placement);
}

}  // namespace

MachineResult search_machine(const Evaluator& evaluator, const SearchOptions& options,
                             Comparer& comparer) {
  MachineResult result;
  result.machine = evaluator.machine().id;
  result.hash = evaluator.machine().content_hash;
  const bool few = count(choices(evaluator, options.pins)) <= options.enumerate;
  Explored explored(evaluator, options, few ? options.enumerate : options.budget);
  result.placements = count(explored.choices());
  const Bounds root = explored.bounder(Drops::none).root();
  result.path_bound_ns = root.path_ns;
  result.load_bound_ns = root.load_ns;
  search(explored, result);
  for (const Drops drops : {Drops::possible, Drops::none}) check_bound(explored, drops);
  const std::vector<std::size_t> order = ranked(explored);
  result.evaluated = explored.points().size();
  result.infeasible = explored.infeasible();
  result.beyond_limits = result.evaluated - order.size();
  result.refusals = explored.refusals();
  if (order.empty()) {
    result.unreachable = why_unreachable(explored, result);
    return result;
  }
  result.bound = convert(options.objective, result.bound);
  const Point& best = explored.points()[order.front()];
  result.best = detailed(explored, best);
  result.parts = parts(evaluator, best.placement);
  result.explanation =
      explain(evaluator, best.placement, result.best->figures, best.score, options.objective);
  add_rivals(explored, order, comparer, result);
  if (result.next) {
    result.explanation.lines.push_back(describe(*result.next, options.objective));
  }
  add_front(explored, order, result);
  return result;
}

}  // namespace partita::partition
