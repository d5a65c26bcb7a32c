// The simulator against the real Timeline: the same times to the nanosecond, for random pipelines,
// workloads and placements on the declared machines.
#include "partition/simulate/simulator.h"

#include <gtest/gtest.h>

#include "tests/partition/random_world.h"

namespace partita::partition {
namespace {

using test::RandomWorld;
using test::WorldOptions;

const std::string kProfiles = PARTITA_SOURCE_DIR "/profiles";

std::vector<profile::Machine> machines() {
  std::vector<profile::Machine> all;
  for (const std::string& name : profile::list_machines(kProfiles)) {
    all.push_back(profile::load_machine(name, kProfiles));
  }
  return all;
}

void expect_equal(const Distribution& a, const Distribution& b, const char* what) {
  EXPECT_EQ(a.mean, b.mean) << what;
  EXPECT_EQ(a.p50, b.p50) << what;
  EXPECT_EQ(a.p99, b.p99) << what;
  EXPECT_EQ(a.max, b.max) << what;
}

void expect_same_quick(const Figures& a, const Figures& b) {
  expect_equal(a.latency, b.latency, "latency");
  expect_equal(a.perception, b.perception, "perception");
  EXPECT_EQ(a.throughput_hz, b.throughput_hz);
  EXPECT_EQ(a.late, b.late);
  EXPECT_EQ(a.dropped, b.dropped);
  EXPECT_EQ(a.dropped_by_tasks, b.dropped_by_tasks);
  EXPECT_EQ(a.makespan, b.makespan);
  EXPECT_NEAR(a.energy_per_frame_j, b.energy_per_frame_j, 1e-9 * (1 + b.energy_per_frame_j));
  EXPECT_EQ(a.price_usd, b.price_usd);
}

void expect_equal(const Figures& a, const Figures& b) {
  expect_same_quick(a, b);
  expect_equal(a.age, b.age, "age");
  ASSERT_EQ(a.engines.size(), b.engines.size());
  for (std::size_t i = 0; i < a.engines.size(); ++i) {
    EXPECT_EQ(a.engines[i].name, b.engines[i].name);
    EXPECT_EQ(a.engines[i].busy, b.engines[i].busy) << a.engines[i].name;
  }
  ASSERT_EQ(a.tasks.size(), b.tasks.size());
  for (std::size_t i = 0; i < a.tasks.size(); ++i) {
    expect_equal(a.tasks[i].latency, b.tasks[i].latency, "a task's latency");
    expect_equal(a.tasks[i].duration, b.tasks[i].duration, "a task's duration");
    EXPECT_EQ(a.tasks[i].dropped, b.tasks[i].dropped);
    EXPECT_EQ(a.tasks[i].late, b.tasks[i].late);
  }
}

class SimulatorTest : public ::testing::TestWithParam<bool> {};  // swapping allowed?

TEST_P(SimulatorTest, TheCompiledFormEqualsTheTimelineToTheNanosecond) {
  const auto all = machines();
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    RandomWorld world(seed);
    const profile::Machine& machine = all[seed % all.size()];
    SimulatorOptions options;
    options.frames = 20;
    options.allow_swap = GetParam();
    const Simulator simulator(machine, world.pipeline, world.workload, options);
    for (int i = 0; i < 4; ++i) {
      const TaskPlacement placement = world.placement(simulator);
      if (!simulator.infeasible(placement).empty()) continue;
      SCOPED_TRACE("seed " + std::to_string(seed) + " on " + machine.id + ": " +
                   simulator.name(placement));
      const Reference reference = simulator.reference(placement);
      expect_equal(simulator.run(placement), reference.figures);
      ASSERT_FALSE(HasFailure());
      for (const timeline::ScheduledCommand& c : reference.schedule.commands) {
        ASSERT_EQ(c.times, reference.record.commands[c.command].live) << "of the replay";
      }
    }
  }
}

TEST_P(SimulatorTest, FramesThatRepeatNeedNotAllBeSimulated) {
  const auto all = machines();
  for (std::uint32_t seed = 0; seed < 240; ++seed) {
    WorldOptions world_options;
    world_options.recorded_frames = 1 + seed % 3 * 2;
    RandomWorld world(seed, world_options);
    world.pipeline.period_ns *= 1 + seed % 5 * 3;
    SimulatorOptions options;
    options.frames = 40 + seed % 13;
    options.allow_swap = GetParam();
    const Simulator simulator(all[seed % all.size()], world.pipeline, world.workload, options);
    for (int i = 0; i < 4; ++i) {
      const TaskPlacement placement = world.placement(simulator);
      if (!simulator.infeasible(placement).empty()) continue;
      SCOPED_TRACE("seed " + std::to_string(seed) + ": " + simulator.name(placement));
      expect_same_quick(simulator.quick(placement), simulator.run(placement));
      ASSERT_FALSE(HasFailure());
    }
  }
}

/// One simulator for many placements, which share what it remembers; frames that overlap, wait and
/// are dropped, over many cycles.
TEST(Simulator, WhatItRemembersOfOtherPlacementsAndFramesChangesNothing) {
  const auto all = machines();
  std::size_t dropping = 0, complete = 0;
  for (std::uint32_t seed = 0; seed < 120; ++seed) {
    WorldOptions world_options;
    world_options.recorded_frames = 1 + seed % 4;
    RandomWorld world(1000 + seed, world_options);
    world.pipeline.period_ns = world.pipeline.period_ns / (1 + seed % 4 * 8) + 1;
    SimulatorOptions options;
    options.frames = 30 + seed % 7 * 40;
    const Simulator simulator(all[seed % all.size()], world.pipeline, world.workload, options);
    std::vector<TaskPlacement> placements;
    for (int i = 0; i < 12; ++i) placements.push_back(world.placement(simulator));
    for (std::size_t i = 0; i < 2 * placements.size(); ++i) {
      const TaskPlacement& placement = placements[i % placements.size()];
      if (!simulator.infeasible(placement).empty()) continue;
      SCOPED_TRACE("seed " + std::to_string(seed) + ", look " + std::to_string(i) + ": " +
                   simulator.name(placement));
      const Figures quick = simulator.quick(placement);
      expect_same_quick(quick, simulator.run(placement));
      ASSERT_FALSE(HasFailure());
      ++(quick.dropped_by_tasks > 0 ? dropping : complete);
    }
  }
  EXPECT_GT(dropping, 400u);
  EXPECT_GT(complete, 400u);
}

INSTANTIATE_TEST_SUITE_P(All, SimulatorTest, ::testing::Bool());

}  // namespace
}  // namespace partita::partition
