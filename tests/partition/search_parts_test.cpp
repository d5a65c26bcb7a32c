// What the search is made of: bounds, front, comparison under uncertainty, sanity gate.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "partition/search/bound.h"
#include "partition/search/compare.h"
#include "partition/search/pareto.h"
#include "partition/search/sanity.h"
#include "tests/partition/synthetic.h"

namespace partita::partition {
namespace {

using test::small_machine;
using test::Synthetic;
using ::testing::HasSubstr;

TEST(Pareto, DominationNeedsOneBetterAndNoneWorse) {
  const Score a{
      .p50_ns = 1, .p99_ns = 2, .energy_j = 3, .frame_ns = 4, .area = 0.5, .price_usd = 6};
  EXPECT_FALSE(dominates(a, a));
  for (double Score::*figure : {&Score::p50_ns, &Score::p99_ns, &Score::energy_j, &Score::frame_ns,
                                &Score::area, &Score::price_usd}) {
    Score better = a;
    better.*figure /= 2;
    EXPECT_TRUE(dominates(better, a));
    EXPECT_FALSE(dominates(a, better));
    Score mixed = better;
    (figure == &Score::p50_ns ? mixed.p99_ns : mixed.p50_ns) *= 2;
    EXPECT_FALSE(dominates(mixed, a));
    EXPECT_FALSE(dominates(a, mixed));
  }
}

TEST(Pareto, TheFrontEqualsItsDefinition) {
  std::mt19937 random(1);
  for (int round = 0; round < 50; ++round) {
    std::vector<Score> scores(random() % 60);
    for (Score& s : scores) {
      for (double Score::*figure : {&Score::p50_ns, &Score::p99_ns, &Score::energy_j,
                                    &Score::frame_ns, &Score::area, &Score::price_usd}) {
        s.*figure = static_cast<double>(random() % 4);
      }
    }
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < scores.size(); ++i) {
      if (std::none_of(scores.begin(), scores.end(),
                       [&](const Score& s) { return dominates(s, scores[i]); })) {
        expected.push_back(i);
      }
    }
    EXPECT_EQ(pareto_front(scores), expected);
  }
}

Choices all_places(const Evaluator& evaluator) {
  return choices(evaluator, {});
}

TEST(Bounds, NoCompletionOfAPartialPlacementIsBelow) {
  std::mt19937 random(2);
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    const Synthetic evaluator(small_machine(2), 4, seed);
    const Choices space = all_places(evaluator);
    const Bounder bounder(evaluator, space, Drops::none);
    for (std::uint64_t i = 0; i < count(space); ++i) {
      const TaskPlacement placement = nth(space, i);
      TaskPlacement partial = placement;
      for (std::uint32_t& place : partial) {
        if (random() % 2 == 0) place = kOpen;
      }
      const Bounds less = bounder(partial), whole = bounder(placement);
      for (const Objective objective : kObjectives) {
        EXPECT_LE(less.cost(objective), whole.cost(objective) * (1 + 1e-12));
        EXPECT_LE(bounder.root().cost(objective), less.cost(objective) * (1 + 1e-12));
      }
      // score_of throws if an evaluation is below the bounds.
      EXPECT_NO_THROW(score_of(evaluator, placement, evaluator.quick(placement), whole));
    }
  }
}

TEST(Bounds, AFasterDeviceNeverMakesThemWorse) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    const Synthetic evaluator(small_machine(2), 5, seed);
    const Choices space = all_places(evaluator);
    const Bounds before = Bounder(evaluator, space, Drops::possible).root();
    for (std::size_t d = 0; d < evaluator.machine().devices.size(); ++d) {
      Speeds speeds;
      speeds.devices.assign(evaluator.machine().devices.size(), 1);
      speeds.devices[d] = 1.5;
      const auto faster = evaluator.with(speeds);
      const Bounds after = Bounder(*faster, space, Drops::possible).root();
      for (const Objective objective : kObjectives) {
        EXPECT_LE(after.cost(objective), before.cost(objective)) << to_string(objective);
      }
    }
  }
}

/// Three tasks: 0 and 1 feed 2. Task 1 may drop; 0 runs on every second frame where asked.
struct DroppingPipeline {
  DroppingPipeline() : evaluator(small_machine(), 3, 1) {
    for (std::uint32_t t = 0; t < 3; ++t) {
      evaluator.places_[t] = {{true, t, evaluator.machine_.devices[t].name}};
      evaluator.duration_[t] = {100.0 * (t + 1)};
      evaluator.pipeline_.tasks[t].inputs.clear();
    }
    evaluator.pipeline_.period_ns = 1000;
    evaluator.pipeline_.tasks[2].inputs = {{0, "out"}, {1, "out"}};
    evaluator.pipeline_.outputs = {2};
    evaluator.fill_least();
  }
  Bounds bounds() { return Bounder(evaluator, all_places(evaluator), Drops::possible).root(); }
  Synthetic evaluator;
};

TEST(Bounds, ThePathGoesOnlyThroughWhatIsSurelyWaitedFor) {
  DroppingPipeline p;
  EXPECT_EQ(p.bounds().path_ns, 200 + 300);
  p.evaluator.pipeline_.tasks[1].when_full = WhenFull::drop_oldest;
  EXPECT_EQ(p.bounds().path_ns, 100 + 300) << "what 1 drops, 2 does not wait for";
  p.evaluator.pipeline_.tasks[0].every = 2;
  EXPECT_EQ(p.bounds().path_ns, 300) << "on odd frames only 1 is waited for, if it is there";
  p.evaluator.pipeline_.tasks[2].every = 2;
  EXPECT_EQ(p.bounds().path_ns, 100 + 300);
}

TEST(Bounds, AnOverloadedEngineMakesLaterFramesWait) {
  DroppingPipeline p;
  p.evaluator.pipeline_.period_ns = 250;  // task 2 takes 300
  const Bounds bounds = p.bounds();
  EXPECT_EQ(bounds.frame_ns, 300);
  EXPECT_EQ(bounds.p99_ns, 10 * 300 - 9 * 250);
  EXPECT_EQ(bounds.p50_ns, 5 * 300 - 4 * 250 < 500 ? 500 : 5 * 300 - 4 * 250);
  p.evaluator.pipeline_.tasks[2].when_full = WhenFull::drop_newest;
  EXPECT_EQ(p.bounds().p99_ns, 500) << "what is late is dropped instead";
}

/// Task 0 alone decides: 1,000 on one card, `other` on the second one.
struct TwoCards {
  explicit TwoCards(double other) : evaluator(small_machine(2), 1, 1) {
    evaluator.places_[0] = {{true, 1, "card0"}, {true, 2, "card1"}};
    evaluator.duration_[0] = {1000, other};
    evaluator.pipeline_.period_ns = 10'000;
    evaluator.fill_least();
  }
  Comparison compare(Objective objective = Objective::latency) {
    return Comparer(objective).compare(evaluator, {0}, evaluator, {1});
  }
  Synthetic evaluator;
};

TEST(Comparison, DifferentDevicesHaveToDifferByBothUncertainties) {
  // At 25 %, 1,000 may be 1,250, and x may be 0.75 x: x has to be above 1,667.
  EXPECT_FALSE(TwoCards(1600).compare().beats);
  const Comparison clear = TwoCards(1700).compare();
  EXPECT_TRUE(clear.beats);
  EXPECT_EQ(clear.nominal, 700);
  EXPECT_NEAR(clear.least, 1700 * 0.75 - 1000 * 1.25, 2);
  EXPECT_EQ(clear.by, Objective::latency);
}

TEST(Comparison, StatedUncertaintiesCount) {
  TwoCards cards(1600);
  cards.evaluator.machine_.devices[1].profile.uncertainty = 0.1;
  EXPECT_TRUE(cards.compare().beats) << "1,100 against 1,200";
  cards.evaluator.machine_.devices[2].profile.uncertainty = 0.4;
  EXPECT_FALSE(cards.compare().beats);
  const std::vector<Part> used = parts(cards.evaluator, {0});
  ASSERT_EQ(used.size(), 2u);
  EXPECT_EQ(used[0], (Part{"card0", 0.1, false}));
  EXPECT_EQ(used[1], (Part{"host", profile::kDefaultUncertainty, true}));
}

TEST(Comparison, ACommonDeviceCancels) {
  Synthetic evaluator(small_machine(2), 2, 1);
  // Task 0 on the same card in both, task 1 on it too or on the fast fabric.
  evaluator.places_ = {{{true, 1, "card0"}}, {{true, 1, "card0"}, {true, 0, "fabric"}}};
  evaluator.duration_ = {{1000}, {10, 30}};
  evaluator.pipeline_.tasks[1].inputs = {{0, "out"}};
  evaluator.pipeline_.period_ns = 100'000;
  evaluator.fill_least();
  const Comparison c = Comparer(Objective::latency).compare(evaluator, {0, 0}, evaluator, {0, 1});
  EXPECT_TRUE(c.beats) << "2 % apart, but the 1,000 are the same card's in both";
  EXPECT_EQ(c.nominal, 20);
  EXPECT_NEAR(c.least, 0.75 * 30 - 1.25 * 10, 2);
}

TEST(Comparison, EqualPricesAreDecidedByLatency) {
  TwoCards cards(2000);
  for (auto& device : cards.evaluator.machine_.devices) device.profile.price_usd = 100;
  const Comparison c = cards.compare(Objective::cost);
  EXPECT_EQ(c.by, Objective::latency);
  EXPECT_TRUE(c.beats);
  cards.evaluator.machine_.devices[2].profile.price_usd = 101;
  const Comparison price = cards.compare(Objective::cost);
  EXPECT_EQ(price.by, Objective::cost);
  EXPECT_TRUE(price.beats) << "prices are no predictions";
}

struct SanityGate : ::testing::Test {
  SanityGate() : evaluator(small_machine(), 3, 9), placement(3, 0) {
    figures = evaluator.evaluate(placement);
    bounds = Bounder(evaluator, all_places(evaluator), Drops::possible)(placement);
  }
  std::string error() {
    try {
      check_plausible(evaluator, placement, figures, bounds);
    } catch (const profile::Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("machine 'synthetic', placement t0="));
      return error.what();
    }
    return "";
  }
  Synthetic evaluator;
  TaskPlacement placement;
  Figures figures;
  Bounds bounds;
};

TEST_F(SanityGate, LetsWhatIsPossiblePass) {
  EXPECT_EQ(error(), "");
}

TEST_F(SanityGate, RefusesWhatIsNot) {
  const Figures good = figures;
  const auto with = [&](const auto& change) {
    figures = good;
    change(figures);
    return error();
  };
  EXPECT_THAT(with([](Figures& f) { f.energy_per_frame_j = 0; }),
              HasSubstr("energy per frame of 0"));
  EXPECT_THAT(with([](Figures& f) { f.energy_per_frame_j = NAN; }), HasSubstr("energy"));
  EXPECT_THAT(with([](Figures& f) { f.energy_per_frame_j /= 1e6; }),
              HasSubstr("expected at least"));
  EXPECT_THAT(with([](Figures& f) { f.power_w = -3; }), HasSubstr("power of -3 W"));
  EXPECT_THAT(with([](Figures& f) { f.power_w = INFINITY; }), HasSubstr("power"));
  EXPECT_THAT(with([](Figures& f) { f.power_w = 1e6; }), HasSubstr("all parts at full load"));
  EXPECT_THAT(with([](Figures& f) { f.latency.p50 = 0; }), HasSubstr("latency p50 of 0"));
  EXPECT_THAT(with([](Figures& f) { f.latency.p50 = f.latency.max + 1; }), HasSubstr("the p99"));
  EXPECT_THAT(with([](Figures& f) { f.latency.p50 = 1; }), HasSubstr("critical path"));
  EXPECT_THAT(with([](Figures& f) { f.latency.mean = NAN; }), HasSubstr("mean latency"));
  EXPECT_THAT(with([](Figures& f) { f.price_usd = -1; }), HasSubstr("price"));
  EXPECT_THAT(with([](Figures& f) { f.price_usd = 1; }), HasSubstr("the parts in use"));
  EXPECT_THAT(with([](Figures& f) { f.throughput_hz *= 100; }), HasSubstr("time between frames"));
  EXPECT_THAT(with([](Figures& f) { f.throughput_hz = -1; }), HasSubstr("throughput"));
  EXPECT_THAT(with([](Figures& f) { f.engines[0].share = 1.01; }),
              HasSubstr("utilisation of fabric"));
  EXPECT_THAT(with([](Figures& f) { f.engines[0].share = -0.1; }), HasSubstr("utilisation"));
}

}  // namespace
}  // namespace partita::partition
