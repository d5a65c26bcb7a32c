// Busy intervals and shared bandwidth, against slow and obvious models of the same.
#include <random>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "devices/timeline/calendar.h"

namespace partita::timeline {
namespace {

TEST(BusyTimes, FirstFitMatchesASearchMinuteByMinute) {
  std::mt19937 random(4);
  BusyTimes busy;
  std::set<Ns> taken;
  for (int i = 0; i < 400; ++i) {
    const Ns ready = random() % 600, duration = 1 + random() % 9;
    Ns expected = ready;
    const auto blocked = [&](Ns start) {
      const auto hit = taken.lower_bound(start);
      return hit != taken.end() && *hit < start + duration;
    };
    while (blocked(expected)) ++expected;
    ASSERT_EQ(busy.first_fit(ready, duration), expected);
    busy.reserve(expected, expected + duration);
    for (Ns t = expected; t < expected + duration; ++t) taken.insert(t);
  }
  EXPECT_THROW(busy.reserve(*taken.begin(), *taken.begin() + 1), std::logic_error);
}

TEST(BusyTimes, StaysBoundedAndClosesItsPast) {
  BusyTimes busy;
  for (Ns i = 0; i < 100'000; ++i) busy.reserve(3 * i, 3 * i + 1);
  EXPECT_EQ(busy.first_fit(300'000, 5), 300'000u);
  EXPECT_GT(busy.first_fit(0, 1), 200'000u);
  EXPECT_THROW(busy.reserve(1, 2), std::logic_error);
}

TEST(Bandwidth, ConservesWhatCommandsDrawAndNeverExceedsTheWhole) {
  std::mt19937 random(11);
  for (int round = 0; round < 50; ++round) {
    Bandwidth memory;
    std::vector<std::uint64_t> used(4000, 0);
    for (int i = 0; i < 30; ++i) {
      const Ns start = random() % 500, busy = 1 + random() % 60;
      const auto share = static_cast<std::uint32_t>(1 + random() % Bandwidth::kWhole);
      const Ns end = memory.stretched_end(start, busy, share);
      ASSERT_GE(end, start + busy);
      std::uint64_t drawn = 0, last = 0;
      for (Ns t = start; t < end; ++t) {
        last = std::min<std::uint64_t>(share, Bandwidth::kWhole - used[t]);
        drawn += last;
        used[t] += last;
      }
      EXPECT_GE(drawn, busy * share);         // all of it
      EXPECT_LT(drawn, busy * share + last);  // and no nanosecond more than it takes
      memory.reserve(start, end, share);
      for (Ns t = 0; t < used.size(); ++t) {
        ASSERT_LE(used[t], Bandwidth::kWhole);
        ASSERT_EQ(memory.used(t), used[t]) << t;
      }
    }
  }
}

TEST(Bandwidth, StaysBounded) {
  Bandwidth memory;
  for (Ns i = 0; i < 50'000; ++i) memory.reserve(3 * i, 3 * i + 2, 1 + i % 7);
  EXPECT_GT(memory.open_from(0), 100'000u);
  EXPECT_EQ(memory.stretched_end(1'000'000, 10, 5), 1'000'010u);
}

}  // namespace
}  // namespace partita::timeline
