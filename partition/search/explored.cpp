#include "partition/search/explored.h"

#include <algorithm>

#include "partition/search/parallel.h"
#include "partition/search/sanity.h"

namespace partita::partition {

Explored::Explored(const Evaluator& evaluator, const SearchOptions& options, std::uint64_t budget)
    : evaluator_(evaluator),
      options_(options),
      choices_(partition::choices(evaluator, options.pins)),
      any_(evaluator, choices_, Drops::possible),
      complete_(evaluator, choices_, Drops::none),
      budget_(budget),
      threads_(options.threads != 0 ? options.threads
                                    : std::max(1u, std::thread::hardware_concurrency())) {}

Explored::Look Explored::look(const TaskPlacement& placement) const {
  Look look;
  look.refusal = evaluator_.infeasible(placement);
  if (!look.refusal.empty()) return look;
  const Figures figures = evaluator_.quick(placement);
  if (figures.latency.max == 0 && figures.dropped > 0) {
    look.refusal = "finishes no frame: its outputs never do the same one";
    return look;
  }
  look.score = score_of(evaluator_, placement, figures, bounder(drops_of(figures))(placement));
  return look;
}

std::size_t Explored::look_at(std::span<const TaskPlacement> placements) {
  std::vector<std::map<TaskPlacement, std::size_t>::iterator> fresh;
  for (const TaskPlacement& placement : placements) {
    const auto [entry, is_new] = index_.try_emplace(placement, kNone);
    if (is_new) fresh.push_back(entry);
  }
  if (fresh.empty() || stopped_) return 0;
  std::vector<Look> looks(fresh.size());
  parallel_for(fresh.size(), threads_, [&](std::size_t i) { looks[i] = look(fresh[i]->first); });
  const std::size_t before = points_.size();
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    if (!looks[i].refusal.empty()) {
      refuse(looks[i].refusal, fresh[i]->first);
      continue;
    }
    const std::size_t point = fresh[i]->second = points_.size();
    points_.push_back({fresh[i]->first, looks[i].score});
    const bool within = options_.limits.met(looks[i].score);
    if (within && (best_ == kNone || better(point, best_))) best_ = point;
  }
  if (options_.progress) {
    stopped_ = !options_.progress({evaluator_.machine().id, points_.size(), budget_});
  }
  return points_.size() - before;
}

void Explored::refuse(const std::string& reason, const TaskPlacement& placement) {
  ++infeasible_;
  const auto [entry, is_new] = reasons_.try_emplace(reason, refusals_.size());
  if (is_new) refusals_.push_back({reason, 0, evaluator_.name(placement)});
  ++refusals_[entry->second].count;
}

std::size_t Explored::find(const TaskPlacement& placement) const {
  const auto found = index_.find(placement);
  return found == index_.end() ? kNone : found->second;
}

bool Explored::better(std::size_t a, std::size_t b) const {
  const Point &p = points_[a], &q = points_[b];
  const double beyond_p = options_.limits.excess(p.score),
               beyond_q = options_.limits.excess(q.score);
  if (beyond_p != beyond_q) return beyond_p < beyond_q;
  if (ranks_before(options_.objective, p.score, q.score)) return true;
  if (ranks_before(options_.objective, q.score, p.score)) return false;
  return p.placement < q.placement;
}

std::vector<Refusal> Explored::refusals() const {
  std::vector<Refusal> sorted = refusals_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Refusal& a, const Refusal& b) { return a.count > b.count; });
  return sorted;
}

}  // namespace partita::partition
