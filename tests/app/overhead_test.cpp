// When a difference between two sets of measurements says anything.
#include "host/app/overhead.h"

#include <gtest/gtest.h>

namespace partita::app {
namespace {

std::vector<Batch> batches(const std::vector<double>& values) {
  std::vector<Batch> list;
  for (const double value : values) list.push_back({value, 2 * value});
  return list;
}

TEST(Overhead, QuartilesAreByNearestRankAndPerFigure) {
  const auto list = batches({50, 10, 40, 20, 30});
  const Quartiles calls = quartiles(list, &Batch::calls);
  EXPECT_EQ(calls.low, 20);
  EXPECT_EQ(calls.median, 30);
  EXPECT_EQ(calls.high, 40);
  EXPECT_EQ(quartiles(list, &Batch::all).median, 60);
  EXPECT_EQ(quartiles(batches({7}), &Batch::calls).range(), 0);
}

TEST(Overhead, ADifferenceWithinTheScatterIsNoise) {
  const Quartiles quiet{99, 100, 101}, loud{80, 95, 120}, far{149, 150, 151};
  EXPECT_TRUE(below_noise(quiet, loud));
  EXPECT_TRUE(below_noise(loud, quiet));
  EXPECT_FALSE(below_noise(quiet, far));
}

}  // namespace
}  // namespace partita::app
