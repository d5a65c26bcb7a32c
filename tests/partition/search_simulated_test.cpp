// The search on the simulator: bounds hold for random pipelines, workloads and placements on the
// declared machines, and the search finds what looking at everything finds.
#include <gtest/gtest.h>

#include "partition/search/sanity.h"
#include "partition/search/search.h"
#include "partition/search/simulated.h"
#include "tests/partition/random_world.h"

namespace partita::partition {
namespace {

using test::RandomWorld;
using test::WorldOptions;

const std::string kProfiles = PARTITA_SOURCE_DIR "/profiles";

std::vector<profile::Machine> machines() {
  std::vector<profile::Machine> all;
  for (const char* name : {"dragonfly", "tx2", "cpu-only"}) {
    all.push_back(profile::load_machine(name, kProfiles));
  }
  return all;
}

TEST(SimulatedSearch, NoPlacementIsBelowItsBoundsNorBelowThoseOfAllPlacements) {
  std::size_t dropping = 0, all_done = 0;
  for (const profile::Machine& machine : machines()) {
    for (std::uint32_t seed = 1; seed <= 400; ++seed) {
      RandomWorld world(seed);
      const auto evaluator = simulated(machine, world.pipeline, world.workload,
                                       {.frames = 1 + seed % 40, .allow_swap = seed % 3 == 0});
      const Choices space = choices(*evaluator, {});
      const Bounder any(*evaluator, space, Drops::possible);
      const Bounder complete(*evaluator, space, Drops::none);
      for (int i = 0; i < 8; ++i) {
        const TaskPlacement placement = nth(space, world.pick(count(space)));
        if (!evaluator->infeasible(placement).empty()) continue;
        const Figures figures = evaluator->evaluate(placement);
        if (figures.latency.p50 == 0) continue;  // most frames are not finished, or ask for nothing
        const bool drops = drops_of(figures) == Drops::possible;
        const Bounder& bounder = drops ? any : complete;
        const Bounds bounds = bounder(placement), root = bounder.root(), least = any(placement);
        ASSERT_NO_THROW(check_plausible(*evaluator, placement, figures, bounds))
            << machine.id << " seed " << seed << " " << evaluator->name(placement);
        const Score score = score_of(*evaluator, placement, figures, bounds);
        for (const Objective objective : kObjectives) {
          ASSERT_LE(root.cost(objective), cost(objective, score) * (1 + 1e-9));
          ASSERT_LE(least.cost(objective), bounds.cost(objective) * (1 + 1e-9));
        }
        ++(drops ? dropping : all_done);
      }
    }
  }
  EXPECT_GT(dropping, 500u);
  EXPECT_GT(all_done, 1000u);
}

TEST(SimulatedSearch, FasterPartsNeverMakeTheBoundsWorse) {
  for (const profile::Machine& machine : machines()) {
    for (std::uint32_t seed = 1; seed <= 25; ++seed) {
      RandomWorld world(seed);
      const auto evaluator = simulated(machine, world.pipeline, world.workload, {.frames = 20});
      const Choices space = choices(*evaluator, {});
      const Bounds before = Bounder(*evaluator, space, Drops::possible).root();
      Speeds speeds;
      speeds.devices.assign(machine.devices.size(), 1);
      speeds.nodes.assign(machine.nodes.size(), 1);
      (seed % 2 == 0 ? speeds.devices : speeds.nodes)[0] = 1.7;
      const auto faster = evaluator->with(speeds);
      const Bounds after = Bounder(*faster, space, Drops::possible).root();
      for (const Objective objective : kObjectives) {
        EXPECT_LE(after.cost(objective), before.cost(objective)) << machine.id << " seed " << seed;
      }
    }
  }
}

TEST(SimulatedSearch, BranchAndBoundFindsWhatEnumerationFinds) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const profile::Machine machine = profile::load_machine("dragonfly", kProfiles);
    RandomWorld world(seed, {.most_tasks = 4});
    const auto evaluator = simulated(machine, world.pipeline, world.workload, {.frames = 20});
    for (const Objective objective : kObjectives) {
      SearchOptions options;
      options.objective = objective;
      options.tie_candidates = 1;
      const MachineResult all = explore({evaluator.get()}, options).machines[0];
      options.enumerate = 0;
      const MachineResult pruned = explore({evaluator.get()}, options).machines[0];
      EXPECT_EQ(all.best->placement, pruned.best->placement)
          << seed << " " << to_string(objective) << " " << all.best->name << " "
          << pruned.best->name;
      EXPECT_TRUE(pruned.optimal);
      EXPECT_EQ(all.bound, pruned.bound);
    }
  }
}

TEST(SimulatedSearch, ExplainsWithTheMachinesOwnParts) {
  const profile::Machine machine = profile::load_machine("dragonfly", kProfiles);
  RandomWorld world(3, {.most_tasks = 4, .drops = false});
  const auto evaluator = simulated(machine, world.pipeline, world.workload, {.frames = 20});
  const MachineResult result = explore({evaluator.get()}, {}).machines[0];
  ASSERT_TRUE(result.best.has_value());
  EXPECT_FALSE(result.explanation.critical_path.empty());
  EXPECT_FALSE(result.explanation.sensitivities.empty());
  EXPECT_FALSE(result.parts.empty());
  EXPECT_GE(result.best->score.p99_ns, result.path_bound_ns);
  EXPECT_GT(result.best->driving_hours, 0);
}

}  // namespace
}  // namespace partita::partition
