// The summary of a run: two branches over three frames, built on the timeline itself, so that every
// expected number can be worked out by hand.
#include "partition/summary.h"

#include <gtest/gtest.h>

#include "devices/timeline/timeline.h"

namespace partita::partition {
namespace {

using timeline::Command;
using timeline::CommandKind;
using timeline::ThreadId;

constexpr Ns kPeriod = 1'000'000;

/// Two devices on one node; calls, submission and waking cost nothing, so that times are plain.
timeline::Layout layout(bool shared_device) {
  timeline::Layout l;
  l.machine = "test";
  l.nodes = {{"pc", 2, 10'000'000'000, 0, 0, 0}};
  l.devices.push_back({.name = "first",
                       .type = profile::DeviceType::gpu,
                       .memory_bps = 1'000'000'000,
                       .link_bps = 1'000'000'000});
  if (!shared_device) {
    l.devices.push_back(l.devices[0]);
    l.devices[1].name = "second";
  }
  return l;
}

constexpr Ns kDropped = 0;

/// Frame k of each branch takes slow[k] and quick[k] of its device from its arrival on, or is
/// dropped.
struct TwoBranches {
  TwoBranches(bool shared_device, const std::vector<Ns>& quick, const std::vector<Ns>& slow)
      : clock(layout(shared_device)) {
    const ThreadId a = clock.add_thread("a"), b = clock.add_thread("b");
    clock.bind_thread(a, "localization", 0, 0);
    clock.bind_thread(b, "scene", 1, 0);
    const auto first = clock.add_queue(0, false);
    const auto second = clock.add_queue(shared_device ? 0 : 1, false);
    for (std::size_t k = 0; k < quick.size(); ++k) {
      if (quick[k] != kDropped) frame(a, first, "frontend", k, quick[k]);
      if (slow[k] != kDropped) frame(b, second, "depth", k, slow[k]);
      arrivals.push_back({static_cast<std::int64_t>(k), k * kPeriod});
    }
    machine.nodes.resize(1);
    machine.devices.resize(shared_device ? 1 : 2);
    for (auto& device : machine.devices) device.profile.power = {.idle_w = 1, .busy_w = 11};
  }

  void frame(ThreadId thread, timeline::QueueId queue, const char* task, std::size_t k,
             Ns duration) {
    clock.wait_until(thread, k * kPeriod);
    clock.set_label(thread, clock.intern(task), static_cast<std::int64_t>(k));
    Command command;
    command.queue = queue;
    command.kind = CommandKind::kernel;
    command.name = clock.intern("kernel");
    command.demand.compute_ns = duration;
    const timeline::NodeId node = clock.enqueue(thread, command);
    ASSERT_TRUE(clock.wait(thread, {&node, 1}));
    clock.release(node);
  }

  Summary summary() const {
    const timeline::Record record = clock.snapshot();
    return summarise(record, timeline::replay(record), machine, arrivals, kPeriod);
  }

  timeline::Timeline clock;
  profile::Machine machine;
  std::vector<Arrival> arrivals;
};

TEST(Summary, TheSlowerBranchIsPerception) {
  const Summary s =
      TwoBranches(false, {100'000, 200'000, 300'000}, {500'000, 400'000, 600'000}).summary();
  ASSERT_EQ(s.branches.size(), 2u);
  EXPECT_EQ(s.branches[0].name, "localization");
  EXPECT_EQ(s.branches[0].latency.max, 300'000u);
  EXPECT_DOUBLE_EQ(s.branches[0].latency.mean, 200'000.0);
  EXPECT_EQ(s.branches[1].latency.p50, 500'000u);
  EXPECT_EQ(s.latency.max, 600'000u);
  EXPECT_DOUBLE_EQ(s.latency.mean, 500'000.0);
  EXPECT_EQ(s.late, 0u);
  EXPECT_EQ(s.makespan, 2 * kPeriod + 600'000);
  EXPECT_NEAR(s.branches[0].throughput_hz.value(), 2e9 / (2.3e6 - 0.1e6), 1e-6);
  EXPECT_NEAR(s.branches[1].throughput_hz.value(), 2e9 / (2.6e6 - 0.5e6), 1e-6);
  EXPECT_EQ(s.throughput_hz, s.branches[0].throughput_hz);
}

TEST(Summary, BranchesThatDropDifferentFrames) {
  const Summary s = TwoBranches(false, {100'000, 100'000, kDropped, 100'000},
                                {500'000, kDropped, 500'000, 500'000})
                        .summary();
  ASSERT_EQ(s.perception.size(), 2u) << "frames 0 and 3 are common";
  EXPECT_EQ(s.processed, 4u);
  EXPECT_NEAR(s.energy_per_frame_j, s.energy.total() / 4, 1e-15);
  EXPECT_NEAR(s.throughput_hz.value(), 2e9 / 3e6, 1e-6) << "3 frames, 3 ms from first to last";
}

TEST(Summary, OneFrameHasNoRate) {
  const Summary s = TwoBranches(false, {100'000, 100'000}, {kPeriod + 1, kDropped}).summary();
  EXPECT_TRUE(s.branches[0].throughput_hz.has_value());
  EXPECT_FALSE(s.branches[1].throughput_hz.has_value());
  EXPECT_FALSE(s.throughput_hz.has_value());
  EXPECT_EQ(TwoBranches(false, {1}, {kPeriod + 1}).summary().late, 1u) << "after one more period";
  EXPECT_EQ(TwoBranches(false, {1}, {kPeriod}).summary().late, 0u);
}

TEST(Summary, AloneIsWithoutTheOtherBranch) {
  // One device for both: the second branch waits for the first, or the first for the second.
  const Summary s = TwoBranches(true, {300'000, 300'000}, {400'000, 400'000}).summary();
  EXPECT_EQ(s.branches[0].alone.max, 300'000u);
  EXPECT_EQ(s.branches[1].alone.max, 400'000u);
  EXPECT_EQ(s.latency.max, 700'000u) << "one device does one thing at a time";
  ASSERT_EQ(s.tasks.size(), 2u);
  EXPECT_EQ(s.tasks[1].task, "depth");
  EXPECT_DOUBLE_EQ(s.tasks[1].alone_ns, 400'000.0);
  ASSERT_FALSE(s.engines.empty());
  double busiest = 0;
  for (const EngineUse& engine : s.engines) busiest = std::max(busiest, engine.share);
  EXPECT_NEAR(busiest, 1'400'000.0 / 1'700'000.0, 1e-9);
}

TEST(Summary, AFrameIsLateWhenTheNextOneIsThere) {
  const Summary s = TwoBranches(false, {1, 1, 1}, {kPeriod, kPeriod + 1, 10}).summary();
  EXPECT_EQ(s.late, 1u) << "only frame 1: frame 0 ends exactly when frame 1 arrives";
}

TEST(Summary, EnergyIsIdlePowerPlusWhatWorkAdds) {
  const Summary s = TwoBranches(false, {kPeriod / 2}, {kPeriod}).summary();
  EXPECT_NEAR(s.energy_per_frame_j, s.energy.total(), 1e-15);
  double busy = 0;
  for (const timeline::EnergyItem& item : s.energy.items) busy += item.busy_j;
  EXPECT_NEAR(busy, 10.0 * 1.5e-3, 1e-9);
  EXPECT_NEAR(s.mean_power_w, s.energy.total() / 1e-3, 1e-9);
}

TEST(Distribution, NearestRank) {
  std::vector<Ns> values;
  for (Ns i = 1; i <= 100; ++i) values.push_back(101 - i);
  const Distribution d = distribution(values);
  EXPECT_EQ(d.p50, 50u);
  EXPECT_EQ(d.p99, 99u);
  EXPECT_EQ(d.max, 100u);
  EXPECT_EQ(distribution({}).max, 0u);
  EXPECT_EQ(distribution({7}).p99, 7u);
}

}  // namespace
}  // namespace partita::partition
