// The vehicle's own pipeline and computer: of all its placements, what the search is told is what
// simulating every command of every frame gives.
#include <gtest/gtest.h>

#include "devices/profile/machine.h"
#include "host/app/workload.h"
#include "partition/search/pins.h"
#include "partition/simulate/simulator.h"

namespace partita::testing {
namespace {

using partition::Distribution;

const std::string kProfiles = PARTITA_SOURCE_PROFILES;

void expect_same(const Distribution& a, const Distribution& b) {
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.p50, b.p50);
  EXPECT_EQ(a.p99, b.p99);
  EXPECT_EQ(a.max, b.max);
}

TEST(Simulate, EveryPlacementOfTheVehicleIsWhatItsCommandsGive) {
  const profile::Machine machine = profile::load_machine("dragonfly", kProfiles);
  const partition::Pipeline pipeline = partition::load_pipeline("dragonfly", kProfiles);
  const partition::Workload workload = app::typical_workload(pipeline);
  partition::SimulatorOptions options;
  options.frames = 50;  // three cycles of 15, and a rest
  const partition::Simulator simulator(machine, pipeline, workload, options);
  partition::Choices all(pipeline.tasks.size());
  for (std::uint32_t t = 0; t < all.size(); ++t) {
    for (std::uint32_t p = 0; p < simulator.places(t).size(); ++p) all[t].push_back(p);
  }
  std::size_t simulated = 0, dropping = 0;
  for (std::uint64_t i = 0; i < partition::count(all); ++i) {
    const partition::TaskPlacement placement = partition::nth(all, i);
    if (!simulator.infeasible(placement).empty()) continue;
    SCOPED_TRACE(simulator.name(placement));
    const partition::Figures quick = simulator.quick(placement), run = simulator.run(placement);
    expect_same(quick.latency, run.latency);
    expect_same(quick.perception, run.perception);
    EXPECT_EQ(quick.throughput_hz, run.throughput_hz);
    EXPECT_EQ(quick.late, run.late);
    EXPECT_EQ(quick.dropped_by_tasks, run.dropped_by_tasks);
    EXPECT_EQ(quick.makespan, run.makespan);
    EXPECT_NEAR(quick.energy_per_frame_j, run.energy_per_frame_j, 1e-9 * run.energy_per_frame_j);
    ASSERT_FALSE(HasFailure());
    ++simulated;
    dropping += run.dropped_by_tasks > 0 ? 1 : 0;
  }
  EXPECT_GT(simulated, 1000u);
  EXPECT_GT(dropping, 100u);
}

}  // namespace
}  // namespace partita::testing
