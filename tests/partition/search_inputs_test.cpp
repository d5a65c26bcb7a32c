// What a user states for a search: objectives, pins, limits, the vehicle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "partition/search/limits.h"
#include "partition/search/pins.h"
#include "partition/search/vehicle.h"
#include "tests/partition/synthetic.h"

namespace partita::partition {
namespace {

using test::small_machine;
using test::Synthetic;
using ::testing::HasSubstr;

template <typename Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const profile::Error& error) {
    EXPECT_THAT(error.what(), ::testing::Not(HasSubstr("\n")));
    return error.what();
  }
  return "";
}

TEST(Objective, IsReadByName) {
  for (const Objective objective : kObjectives) {
    EXPECT_EQ(parse_objective(to_string(objective)), objective);
  }
  EXPECT_THAT(error_of([] { parse_objective("speed"); }),
              HasSubstr("expected one of latency, energy, throughput, cost"));
}

TEST(Objective, WhatLeavesOutWorkRanksBehind) {
  const Score whole{.p99_ns = 100, .energy_j = 2, .frame_ns = 10, .price_usd = 3};
  Score part{.dropped = 0.1, .p99_ns = 50, .energy_j = 1, .frame_ns = 5, .price_usd = 1};
  for (const Objective objective : kObjectives) {
    EXPECT_TRUE(ranks_before(objective, whole, part));
    part.dropped = 0;
    EXPECT_TRUE(ranks_before(objective, part, whole));
    part.dropped = 0.1;
  }
}

TEST(Objective, TiesAreDecidedByLatency) {
  const Score a{.p99_ns = 100, .frame_ns = 10, .price_usd = 3};
  const Score b{.p99_ns = 101, .frame_ns = 10, .price_usd = 3};
  EXPECT_TRUE(ranks_before(Objective::cost, a, b));
  EXPECT_TRUE(ranks_before(Objective::throughput, a, b));
  EXPECT_FALSE(ranks_before(Objective::cost, a, a));
  EXPECT_EQ(value(Objective::throughput, {.frame_ns = 1e8}), 10);
}

TEST(Limits, AreReadWithAndWithoutUnits) {
  Limits limits;
  parse_limit("power=30W", limits);
  parse_limit(" price = 1500 USD ", limits);
  parse_limit("latency=0.1s", limits);
  parse_limit("energy=500mJ", limits);
  EXPECT_EQ(limits[Limited::power], 30.0);
  EXPECT_EQ(limits[Limited::price], 1500.0);
  EXPECT_EQ(limits[Limited::latency], 0.1e9);
  EXPECT_EQ(limits[Limited::energy], 0.5);
  EXPECT_EQ(limits.to_string(), "power=30 W, price=1500 USD, latency=100 ms, energy=0.5 J");
  Limits bare;
  parse_limit("latency=100", bare);
  EXPECT_EQ(bare[Limited::latency], 100e6);
}

TEST(Limits, RefuseWhatCannotBeMeant) {
  for (const char* text :
       {"", "=", "power", "power=", "power=W", "power=30V", "power=-1", "power=0", "power=nan",
        "power=inf", "power=1e999", "power=30W W", "power=30,5", "weight=3", "latency=5min",
        "power=0x10", "power==3", "power=3 4"}) {
    Limits limits;
    EXPECT_NE(error_of([&] { parse_limit(text, limits); }), "") << text;
  }
  Limits limits;
  parse_limit("power=30", limits);
  EXPECT_THAT(error_of([&] { parse_limit("power=20", limits); }), HasSubstr("limited twice"));
}

TEST(Limits, ExcessIsRelative) {
  Limits limits;
  parse_limit("power=10", limits);
  parse_limit("energy=1", limits);
  EXPECT_TRUE(limits.met({.energy_j = 1, .power_w = 10}));
  EXPECT_EQ(limits.excess({.energy_j = 1, .power_w = 10}), 0);
  EXPECT_FALSE(limits.met({.energy_j = 1.5, .power_w = 10}));
  EXPECT_NEAR(limits.excess({.energy_j = 1.5, .power_w = 12}), 0.7, 1e-12);
}

TEST(Pins, AreReadStrictly) {
  const Pin pin = parse_pin(" depth = GTX 1060 ");
  EXPECT_EQ(pin.what, "depth");
  EXPECT_EQ(pin.where, "GTX 1060");
  for (const char* text : {"", "depth", "depth=", "=gpu", "a=b=c"}) {
    EXPECT_THAT(error_of([&] { parse_pin(text); }), HasSubstr("TASK=DEVICE")) << text;
  }
}

struct PinChoices : ::testing::Test {
  PinChoices() : evaluator(small_machine(2), 4, 1) {
    // Every task may run everywhere: fabric, card0, card1, host.
    for (std::uint32_t t = 0; t < 4; ++t) {
      evaluator.places_[t].clear();
      for (std::uint32_t d = 0; d < 4; ++d) {
        evaluator.places_[t].push_back({true, d, evaluator.machine_.devices[d].name});
      }
      evaluator.duration_[t].assign(4, 100);
    }
    evaluator.fill_least();
  }
  std::vector<std::uint32_t> left(std::vector<Pin> pins, std::uint32_t task) {
    return choices(evaluator, pins)[task];
  }
  Synthetic evaluator;
  using Places = std::vector<std::uint32_t>;
};

TEST_F(PinChoices, ByKindIdNodeAndPartOfAName) {
  EXPECT_EQ(left({}, 0), (Places{0, 1, 2, 3}));
  EXPECT_EQ(left({{"t0", "gpu"}}, 0), (Places{1, 2}));
  EXPECT_EQ(left({{"t0", "gpu"}}, 1), (Places{0, 1, 2, 3}));
  EXPECT_EQ(left({{"t0", "card1"}}, 0), (Places{2}));
  EXPECT_EQ(left({{"t0", "CARD"}}, 0), (Places{1, 2}));
  EXPECT_EQ(left({{"t0", "synthetic fab"}}, 0), (Places{0}));
  EXPECT_EQ(left({{"t0", "cpu"}}, 0), (Places{3}));
  EXPECT_EQ(left({{"t0", "pc"}}, 0), (Places{0, 1, 2, 3})) << "the node has them all";
}

TEST_F(PinChoices, OfABranchAreThoseOfItsTasksWithKernels) {
  evaluator.pipeline_.tasks[2].host_only = true;
  const std::vector<Pin> pins{{"even", "gpu"}};
  EXPECT_EQ(left(pins, 0), (Places{1, 2}));
  EXPECT_EQ(left(pins, 1), (Places{0, 1, 2, 3}));
  EXPECT_EQ(left(pins, 2), (Places{0, 1, 2, 3}));
  EXPECT_EQ(left({{"even", "gpu"}, {"t0", "card0"}}, 0), (Places{1}));
}

TEST_F(PinChoices, WhatNothingSatisfiesSaysWhatThereIs) {
  const auto error = [&](std::vector<Pin> pins) {
    return error_of([&] { choices(evaluator, pins); });
  };
  EXPECT_THAT(error({{"t9", "gpu"}}), HasSubstr("expected one of t0, t1, t2, t3, even, odd"));
  EXPECT_THAT(error({{"t0", "tpu"}}), HasSubstr("card0 (gpu)"));
  EXPECT_THAT(error({{"t0", "ca"}}), HasSubstr("three characters"));
  EXPECT_THAT(error({{"t0", "gpu"}, {"t1", "gpu"}, {"t0", "cpu"}}),
              HasSubstr("pin 't0=cpu': contradicts pin t0=gpu for task 't0'"));
  evaluator.places_[1].pop_back();
  EXPECT_THAT(error({{"t1", "cpu"}}),
              HasSubstr("task 't1' cannot run there, expected one of fabric, card0, card1"));
}

TEST(Choices, AreNumberedInOrder) {
  const Choices space{{0, 2}, {1}, {0, 1, 2}};
  ASSERT_EQ(count(space), 6u);
  EXPECT_EQ(nth(space, 0), (TaskPlacement{0, 1, 0}));
  EXPECT_EQ(nth(space, 4), (TaskPlacement{2, 1, 1}));
  for (std::uint64_t i = 1; i < 6; ++i) EXPECT_LT(nth(space, i - 1), nth(space, i));
  EXPECT_EQ(count(Choices(100, {0, 1})), ~std::uint64_t{0});
}

TEST(Vehicle, StoppingDistanceAndDrivingHours) {
  const Vehicle vehicle;
  EXPECT_NEAR(added_stopping_distance_m(vehicle, 100e6), 0.56, 1e-12);
  EXPECT_NEAR(driving_hours(vehicle, 0), 10, 1e-12);
  EXPECT_NEAR(driving_hours(vehicle, 150), 8, 1e-12);
  for (const Vehicle& bad : {Vehicle{0, 1, 1}, Vehicle{1, -1, 1}, Vehicle{1, 1, NAN}}) {
    EXPECT_THROW(check(bad), profile::Error);
  }
}

}  // namespace
}  // namespace partita::partition
