// Properties that the tracking task's golden references, tables and assignment should have.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "host/tasks/tracking/accuracy.h"
#include "host/tasks/tracking/assignment.h"
#include "host/tasks/tracking/golden.h"
#include "host/tasks/tracking/golden_math.h"
#include "host/tasks/tracking/tables.h"
#include "host/tasks/tracking/windows.h"

namespace partita::tracking {
namespace {

std::vector<float> random_plane(int cells, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> plane(plane_size(cells));
  for (float& v : plane) v = static_cast<float>(random() >> 8) / 16777216.0f;
  return plane;
}

int reversed(int k, int cells) {
  int result = 0;
  for (int bit = 1; bit < cells; bit *= 2) result = 2 * result + ((k & bit) != 0 ? 1 : 0);
  return result;
}

TEST(TrackingSpectra, AreThoseOfTheDefinition) {
  for (const int cells : {16, 32}) {
    const std::vector<float> plane = random_plane(cells, 7);
    std::vector<float> spectrum(2 * plane.size());
    golden_spectra(plane, twiddle_table(cells), cells, spectrum);
    const auto n = static_cast<std::size_t>(cells);
    double worst = 0;
    for (const auto& [u, v] : std::vector<std::pair<int, int>>{
             {0, 0}, {1, 0}, {0, 1}, {3, 5}, {cells / 2, 1}, {cells - 1, cells - 2}, {7, 12}}) {
      std::complex<double> sum = 0;
      for (std::size_t y = 0; y < n; ++y) {
        for (std::size_t x = 0; x < n; ++x) {
          const double turn = (u * static_cast<double>(x) + v * static_cast<double>(y)) / cells;
          sum += std::polar(static_cast<double>(plane[y * n + x]), -2 * std::numbers::pi * turn);
        }
      }
      // Transposed, both frequencies bit-reversed.
      const auto at = static_cast<std::size_t>(reversed(u, cells)) * n +
                      static_cast<std::size_t>(reversed(v, cells));
      worst = std::max(
          worst, std::abs(sum - std::complex<double>(spectrum[at], spectrum[at + plane.size()])));
    }
    EXPECT_LT(worst, 2e-4) << cells;  // of sums of up to 1024 numbers
  }
}

TEST(TrackingMath, IsCloseToTheTruth) {
  for (double v = 1e-8; v < 1e12; v *= 1.7) {
    const auto f = static_cast<float>(v);
    EXPECT_NEAR(reciprocal(f) * static_cast<double>(f), 1, 3e-7) << v;
    EXPECT_NEAR(reciprocal_root(f) * std::sqrt(static_cast<double>(f)), 1, 5e-7) << v;
  }
  for (double v = 0; v < 39; v += 0.013) {
    const auto f = static_cast<float>(v);
    EXPECT_NEAR(exp_of_minus(f) / std::exp(-static_cast<double>(f)), 1, 2e-6) << v;
  }
  EXPECT_GT(exp_of_minus(1e30f), 0);
}

TEST(TrackingFilter, FindsAShiftOfItsOwnTemplate) {
  constexpr int kCells = 16;
  const std::size_t plane = plane_size(kCells);
  const std::vector<float> twiddles = twiddle_table(kCells);
  const auto spectra_of = [&](int shift_x, int shift_y) {
    std::vector<float> features(plane * kChannels), spectra(2 * plane * kChannels);
    for (std::size_t c = 0; c < kChannels; ++c) {
      const std::vector<float> base = random_plane(kCells, static_cast<unsigned>(c));
      for (int y = 0; y < kCells; ++y) {
        for (int x = 0; x < kCells; ++x) {
          const int to = (y + shift_y) % kCells * kCells + (x + shift_x) % kCells;
          features[c * plane + static_cast<std::size_t>(to)] =
              base[static_cast<std::size_t>(y * kCells + x)];
        }
      }
    }
    golden_spectra(features, twiddles, kCells, spectra);
    return spectra;
  };
  std::vector<float> label(2 * plane);
  golden_spectra(label_plane(kCells, 1.0), twiddles, kCells, label);
  const std::vector<std::int32_t> slots{0};
  const std::vector<float> rates{1}, first = spectra_of(0, 0);
  const float falloff = 1.0f / (0.36f * kChannels * static_cast<float>(plane));
  std::vector<float> kernels(2 * plane), filters(2 * plane), models(2 * plane * kChannels),
      peak(kPeakEntries);
  golden_correlate(first, first, slots, twiddles, kCells, 1, falloff, kernels);
  golden_train(kernels, first, label, slots, rates, 1e-4f, kCells, filters, models);
  for (const auto& [x, y] : std::vector<std::pair<int, int>>{{0, 0}, {3, 1}, {13, 9}}) {
    golden_correlate(models, spectra_of(x, y), slots, twiddles, kCells, 1, falloff, kernels);
    golden_respond(kernels, filters, slots, twiddles, kCells, 1, peak);
    EXPECT_EQ(peak[1], static_cast<float>(y * kCells + x));
    EXPECT_NEAR(peak[0], 1, 0.05);
    EXPECT_NEAR(peak[2], peak[3], 0.02);  // the label is symmetric
  }
}

TEST(TrackingFeatures, OfAFlatPatchAreZeroAndOfARampLieInOneDirection) {
  constexpr int kCells = 16, kSide = kCell * kCells;
  std::vector<std::uint16_t> patch(kSide * kSide, 1600);
  std::vector<std::int32_t> histograms(plane_size(kCells) * kBins);
  golden_cell_histograms(patch, kCells, histograms);
  EXPECT_EQ(std::accumulate(histograms.begin(), histograms.end(), 0), 0);
  for (int i = 0; i < kSide * kSide; ++i) {
    patch[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(16 * (i % kSide));
  }
  golden_cell_histograms(patch, kCells, histograms);
  // One grey level a pixel to the right: bin 0, 2 * 16 per pixel, weights that sum up to 32 * 32.
  const std::size_t inner = 5 * kCells + 5;
  EXPECT_EQ(histograms[inner], 2 * 16 * 1024);
  for (std::size_t b = 1; b < kBins; ++b) EXPECT_EQ(histograms[b * plane_size(kCells) + inner], 0);
}

TEST(TrackingWindow, SeesTheBoxInTheMiddle) {
  const FilterParameters parameters;
  const Box box{100, 50, 40, 10};
  const Window window = make_window(parameters, box, 1);
  const double last = window[0] + 63.0 * window[2];
  EXPECT_NEAR((window[0] + last) / 2 / 65536, box.centre_x() - 0.5, 0.001);
  EXPECT_EQ(window[4], 0);
  EXPECT_EQ(make_window(parameters, {0, 0, 400, 400}, 1)[4], 3);  // 10.6 px a sample
}

double cheapest(std::span<const double> costs, std::size_t rows, std::size_t columns) {
  // All ways to give the rows different columns.
  std::vector<std::size_t> order(columns);
  std::iota(order.begin(), order.end(), 0u);
  double best = 1e300;
  do {
    double sum = 0;
    for (std::size_t r = 0; r < rows; ++r) sum += costs[r * columns + order[r]];
    best = std::min(best, sum);
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

TEST(TrackingAssignment, IsTheCheapestOfAll) {
  std::mt19937 random(3);
  for (int round = 0; round < 600; ++round) {
    const std::size_t rows = 1 + random() % 6, columns = rows + random() % (7 - rows);
    std::vector<double> costs(rows * columns), turned(costs.size());
    for (double& c : costs) c = static_cast<double>(random() % (round % 2 == 0 ? 4 : 1000)) / 8;
    for (std::size_t i = 0; i < costs.size(); ++i) {
      turned[i % columns * rows + i / columns] = costs[i];
    }
    const double expected = cheapest(costs, rows, columns);
    const auto column_of = assign(costs, rows, columns);
    std::vector<int> taken(columns);
    double sum = 0;
    for (std::size_t r = 0; r < rows; ++r) {
      ASSERT_TRUE(column_of[r]);
      sum += costs[r * columns + *column_of[r]];
      EXPECT_EQ(taken[*column_of[r]]++, 0);
    }
    EXPECT_DOUBLE_EQ(sum, expected);
    // More rows than columns: the same pairs' cost, and some rows stay alone.
    double turned_sum = 0;
    std::size_t pairs = 0;
    const auto row_of = assign(turned, columns, rows);
    for (std::size_t c = 0; c < columns; ++c) {
      if (!row_of[c]) continue;
      ++pairs;
      turned_sum += turned[c * rows + *row_of[c]];
    }
    EXPECT_EQ(pairs, rows);
    EXPECT_DOUBLE_EQ(turned_sum, expected);
  }
  EXPECT_TRUE(assign({}, 0, 3).empty());
  EXPECT_EQ(assign({}, 2, 0).size(), 2u);
}

TEST(TrackingAccuracy, CountsWhatIsMissing) {
  const Box box{10, 10, 20, 20};
  const std::vector<std::optional<Box>> truth{box, std::nullopt, box, box};
  const std::vector<std::optional<Box>> boxes{box, box, Box{20, 10, 20, 20}};
  const Accuracy accuracy = measure(boxes, truth);
  EXPECT_EQ(accuracy.frames, 3u);
  EXPECT_NEAR(accuracy.mean_overlap, (1 + 1.0 / 3) / 3, 1e-12);
  EXPECT_NEAR(accuracy.precision, 2.0 / 3, 1e-12);
}

}  // namespace
}  // namespace partita::tracking
