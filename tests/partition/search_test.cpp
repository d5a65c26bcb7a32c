// The search against all placements, one by one, on random synthetic machines; and what it says
// where nothing can be found.
#include "partition/search/search.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "partition/search/pareto.h"
#include "partition/search/sanity.h"
#include "tests/partition/synthetic.h"

namespace partita::partition {
namespace {

using test::small_machine;
using test::Synthetic;
using ::testing::HasSubstr;

struct Everything {
  std::vector<TaskPlacement> placements;  ///< feasible ones within the limits
  std::vector<Score> scores;
  std::size_t best = 0;
};

Everything everything(const Evaluator& evaluator, const SearchOptions& options) {
  const Choices space = choices(evaluator, options.pins);
  const Bounder bounder(evaluator, space, Drops::none);
  Everything all;
  for (std::uint64_t i = 0; i < count(space); ++i) {
    const TaskPlacement placement = nth(space, i);
    if (!evaluator.infeasible(placement).empty()) continue;
    const Score score =
        score_of(evaluator, placement, evaluator.quick(placement), bounder(placement));
    if (!options.limits.met(score)) continue;
    all.placements.push_back(placement);
    all.scores.push_back(score);
    if (ranks_before(options.objective, score, all.scores[all.best])) {
      all.best = all.scores.size() - 1;
    }
  }
  return all;
}

std::string error_of(const std::vector<const Evaluator*>& evaluators,
                     const SearchOptions& options) {
  try {
    explore(evaluators, options);
  } catch (const profile::Error& error) {
    EXPECT_THAT(error.what(), ::testing::Not(HasSubstr("\n")));
    return error.what();
  }
  return "";
}

struct SearchProperty : ::testing::TestWithParam<Objective> {};

TEST_P(SearchProperty, FindsTheOptimumOfAllPlacements) {
  int compared = 0, proven = 0;
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    const Synthetic evaluator(small_machine(1 + seed % 2), 2 + seed % 4, seed);
    SearchOptions options;
    options.objective = GetParam();
    options.tie_candidates = 2;
    const Everything all = everything(evaluator, options);
    if (all.placements.empty()) continue;
    for (const std::uint64_t enumerate : {std::uint64_t{1'000'000}, std::uint64_t{0}}) {
      options.enumerate = enumerate;
      const MachineResult result = explore({&evaluator}, options).machines[0];
      ASSERT_TRUE(result.best.has_value());
      EXPECT_EQ(result.best->placement, all.placements[all.best]) << "seed " << seed;
      EXPECT_EQ(result.best->score, all.scores[all.best]);
      EXPECT_TRUE(result.optimal);
      EXPECT_EQ(result.bound, value(options.objective, all.scores[all.best]));
      EXPECT_EQ(result.gap, 0);
      EXPECT_EQ(result.method, enumerate > 0 ? Method::enumeration : Method::branch_and_bound);
      proven += result.evaluated < all.placements.size() ? 1 : 0;
    }
    ++compared;
  }
  EXPECT_GT(compared, 50);
  EXPECT_GT(proven, 0) << "branch and bound never left anything out";
}

TEST_P(SearchProperty, WithinLimitsAndPinsToo) {
  for (std::uint32_t seed = 100; seed < 130; ++seed) {
    const Synthetic evaluator(small_machine(2), 4, seed);
    SearchOptions options;
    options.objective = GetParam();
    options.tie_candidates = 1;
    options.pins = {{"t0", "cpu"}};
    const Everything free = everything(evaluator, options);
    ASSERT_FALSE(free.scores.empty());
    // Half way between the least and the most of the price: some are excluded.
    double least = 1e9, most = 0;
    for (const Score& score : free.scores) {
      least = std::min(least, score.price_usd);
      most = std::max(most, score.price_usd);
    }
    options.limits[Limited::price] = (least + most) / 2;
    const Everything all = everything(evaluator, options);
    for (const std::uint64_t enumerate : {std::uint64_t{1'000'000}, std::uint64_t{0}}) {
      options.enumerate = enumerate;
      const MachineResult result = explore({&evaluator}, options).machines[0];
      EXPECT_EQ(result.best->placement, all.placements[all.best]) << "seed " << seed;
      EXPECT_TRUE(result.optimal);
      EXPECT_EQ(evaluator.places(0)[result.best->placement[0]].name, "host");
      for (const Scored& point : result.front) EXPECT_TRUE(options.limits.met(point.score));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Objectives, SearchProperty, ::testing::ValuesIn(kObjectives),
                         [](const auto& test) { return std::string(to_string(test.param)); });

TEST(Search, TheFrontIsAllThatNothingDominates) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const Synthetic evaluator(small_machine(2), 2 + seed % 3, seed);
    const Everything all = everything(evaluator, {});
    if (all.placements.empty()) continue;
    const MachineResult result = explore({&evaluator}, {}).machines[0];
    std::set<TaskPlacement> expected, found;
    for (std::size_t i = 0; i < all.scores.size(); ++i) {
      const bool dominated =
          std::any_of(all.scores.begin(), all.scores.end(),
                      [&](const Score& other) { return dominates(other, all.scores[i]); });
      if (!dominated) expected.insert(all.placements[i]);
    }
    for (const Scored& point : result.front) found.insert(point.placement);
    EXPECT_EQ(found, expected) << "seed " << seed;
    EXPECT_EQ(found.size(), result.front.size());
    EXPECT_TRUE(result.exact_front);
  }
}

TEST(Search, CountsWhatCannotBeAndWhy) {
  Synthetic evaluator(small_machine(), 3, 5);
  evaluator.lut_ = {600, 600, 600};
  const MachineResult result = explore({&evaluator}, {}).machines[0];
  EXPECT_EQ(result.placements, result.evaluated + result.infeasible);
  EXPECT_GT(result.infeasible, 0u);
  std::uint64_t sum = 0;
  for (const Refusal& refusal : result.refusals) {
    sum += refusal.count;
    EXPECT_THAT(refusal.reason, HasSubstr("does not fit fabric"));
    EXPECT_THAT(refusal.example, HasSubstr("=fabric"));
  }
  EXPECT_EQ(sum, result.infeasible);
}

TEST(Search, BeyondItsBudgetItStatesABoundAndAGap) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const Synthetic evaluator(small_machine(2), 9, seed);
    SearchOptions options;
    options.tie_candidates = 1;
    const Everything all = everything(evaluator, options);
    options.enumerate = 10;
    options.budget = 60;
    const MachineResult result = explore({&evaluator}, options).machines[0];
    const double optimum = all.scores[all.best].p99_ns;
    EXPECT_LE(result.bound, optimum) << "seed " << seed;
    EXPECT_GE(result.best->score.p99_ns, optimum);
    EXPECT_NEAR(result.gap, result.best->score.p99_ns / result.bound - 1, 1e-12);
    EXPECT_EQ(result.optimal, result.gap == 0);
    EXPECT_LE(result.evaluated, 60u + 256u);
    EXPECT_FALSE(result.exact_front);
  }
}

TEST(Search, DoesNotDependOnTheNumberOfThreads) {
  for (const std::uint64_t enumerate : {std::uint64_t{100'000}, std::uint64_t{0}}) {
    const Synthetic evaluator(small_machine(2), 7, 3);
    SearchOptions options;
    options.enumerate = enumerate;
    options.tie_candidates = 3;
    options.threads = 1;
    const MachineResult one = explore({&evaluator}, options).machines[0];
    options.threads = 5;
    const MachineResult five = explore({&evaluator}, options).machines[0];
    EXPECT_EQ(one.best->placement, five.best->placement);
    EXPECT_EQ(one.next->placement, five.next->placement);
    EXPECT_EQ(one.evaluated, five.evaluated);
    EXPECT_EQ(one.bound, five.bound);
    ASSERT_EQ(one.front.size(), five.front.size());
    for (std::size_t i = 0; i < one.front.size(); ++i) {
      EXPECT_EQ(one.front[i].placement, five.front[i].placement);
    }
  }
}

TEST(Search, CanBeStopped) {
  const Synthetic evaluator(small_machine(2), 7, 3);
  SearchOptions options;
  int calls = 0;
  options.progress = [&](const Progress& progress) {
    EXPECT_EQ(progress.machine, "synthetic");
    EXPECT_LE(progress.evaluated, progress.budget);
    return ++calls < 2;
  };
  const MachineResult result = explore({&evaluator}, options).machines[0];
  EXPECT_EQ(calls, 2);
  EXPECT_TRUE(result.stopped);
  EXPECT_FALSE(result.exact_front);
  EXPECT_LE(result.bound, result.best->score.p99_ns);
}

TEST(Search, AnUnreachableLimitSaysTheLeastAndHow) {
  const Synthetic evaluator(small_machine(), 3, 7);
  SearchOptions options;
  parse_limit("price=50", options.limits);
  const std::string price = error_of({&evaluator}, options);
  EXPECT_THAT(price, HasSubstr("machine 'synthetic': no placement meets price=50 USD, the least is "
                               "100 USD by t0=host,t1=host,t2=host"));
  options.limits = {};
  parse_limit("latency=1ns", options.limits);
  options.enumerate = 0;
  EXPECT_THAT(error_of({&evaluator}, options), HasSubstr("no placement "));
}

TEST(Search, LimitsThatCannotBeMetTogetherSaySo) {
  const Synthetic evaluator(small_machine(), 4, 11);
  const Everything all = everything(evaluator, {});
  double least_latency = 1e18, least_price = 1e18;
  for (const Score& score : all.scores) {
    least_latency = std::min(least_latency, score.p99_ns);
    least_price = std::min(least_price, score.price_usd);
  }
  SearchOptions options;
  options.limits[Limited::latency] = least_latency;
  options.limits[Limited::price] = least_price;
  ASSERT_TRUE(everything(evaluator, options).scores.empty()) << "another seed, please";
  EXPECT_THAT(error_of({&evaluator}, options), HasSubstr(" together, the closest has "));
}

TEST(Search, SeveralMachinesAreRankedAndShareAFront) {
  const Synthetic one(small_machine(), 4, 21);
  Synthetic two(small_machine(), 4, 21);
  two.machine_.id = "slower";
  for (auto& task : two.duration_) {
    for (double& duration : task) duration *= 4;
  }
  two.fill_least();
  const Exploration both = explore({&two, &one}, {});
  ASSERT_EQ(both.ranking.size(), 2u);
  EXPECT_EQ(both.ranking[0].machine, 1u);
  EXPECT_EQ(both.ranking[1].machine, 0u);
  EXPECT_FALSE(both.ranking[1].tie);
  EXPECT_GT(both.ranking[1].behind.least, 0);
  for (const FrontPoint& point : both.front) EXPECT_EQ(point.machine, 1u);
  EXPECT_EQ(both.front.size(), both.machines[1].front.size());
}

TEST(Search, AMachineThatCannotDoesNotEndTheOthers) {
  const Synthetic one(small_machine(), 3, 21);
  Synthetic without(small_machine(), 3, 21);
  without.machine_.id = "other";
  for (auto& device : without.machine_.devices) {
    if (device.profile.type == profile::DeviceType::gpu)
      device.profile.type = profile::DeviceType::cpu;
  }
  SearchOptions options;
  std::uint32_t task = 0;
  while (one.places(task).size() < 3) ++task;
  options.pins = {{one.pipeline().tasks[task].name, "gpu"}};
  const Exploration both = explore({&without, &one}, options);
  EXPECT_THAT(both.machines[0].unreachable, HasSubstr("machine 'other' has no such device"));
  EXPECT_FALSE(both.machines[0].best.has_value());
  ASSERT_EQ(both.ranking.size(), 1u);
  EXPECT_EQ(both.ranking[0].machine, 1u);
  EXPECT_THAT(error_of({&without}, options), HasSubstr("has no such device"));
}

TEST(Search, TheBestIsExplained) {
  const Synthetic evaluator(small_machine(), 4, 31);
  const MachineResult result = explore({&evaluator}, {}).machines[0];
  const Explanation& e = result.explanation;
  ASSERT_FALSE(e.critical_path.empty());
  double length = 0, slowest = 0;
  for (const PathStep& step : e.critical_path) length += step.waited_ns + step.duration_ns;
  for (const TaskFigures& task : result.best->figures.tasks) {
    slowest = std::max(slowest, task.latency.mean);
  }
  EXPECT_NEAR(length, slowest, 1e-6);
  ASSERT_FALSE(e.sensitivities.empty());
  EXPECT_GT(e.sensitivities.front().gain, 0);
  for (std::size_t i = 1; i < e.sensitivities.size(); ++i) {
    EXPECT_GE(e.sensitivities[i - 1].gain, e.sensitivities[i].gain);
  }
  ASSERT_TRUE(result.next.has_value());
  EXPECT_FALSE(result.next->changes.empty());
  ASSERT_EQ(e.lines.size(), 4u);
  EXPECT_THAT(e.lines[0], HasSubstr("critical path: "));
  EXPECT_THAT(e.lines[1], HasSubstr("busiest engine: fabric, 50 %"));
  EXPECT_THAT(e.lines[2], HasSubstr("twice as fast"));
  EXPECT_THAT(e.lines[3], HasSubstr("next best"));
  EXPECT_NEAR(result.best->added_stopping_m, 5.6e-9 * result.best->score.p99_ns, 1e-12);
}

/// Bounds of a machine that is too optimistic about itself.
struct Boastful : Synthetic {
  using Synthetic::Synthetic;
  Figures quick(const TaskPlacement& placement) const override {
    Figures f = Synthetic::quick(placement);
    f.latency.p50 /= 1000;
    return f;
  }
};

TEST(Search, ImpossibleFiguresAreRefusedNotRanked) {
  const Boastful evaluator(small_machine(), 3, 7);
  EXPECT_THAT(error_of({&evaluator}, {}), HasSubstr("machine 'synthetic', placement t0="));
}

}  // namespace
}  // namespace partita::partition
