// The golden references, which the kernels are held against, have obvious properties of their own.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/tasks/frontend/cases.h"
#include "host/tasks/frontend/golden.h"
#include "host/tasks/frontend/layout.h"
#include "host/tasks/frontend/pattern.h"

namespace partita::frontend {
namespace {

TEST(FrontendLayout, GridNeverExceedsItsQuotaAndNearlyUsesIt) {
  for (const Size size : {Size{64, 64}, Size{1226, 370}, Size{1280, 720}, Size{4096, 64}}) {
    for (const int quota : {4, 100, 1180, 2048}) {
      const Grid grid = finest_grid(size, quota);
      EXPECT_LE(grid.cells() * kPerCell, quota);
      EXPECT_EQ(grid.cell % 2, 0);
      if (grid.cell > 2) {
        EXPECT_GT(make_grid(size, grid.cell - 2).cells() * kPerCell, quota);
      }
    }
  }
}

TEST(FrontendLayout, LevelOneScalesBackByTheSixFifths) {
  for (int x = 0; x < 3400; ++x) {
    EXPECT_NEAR(to_original_q8(x, 1) / 256.0, 1.2 * x + 0.1, 0.05);
    EXPECT_EQ(to_original_q8(x, 0), 256 * x);
  }
}

TEST(GoldenPyramid, KeepsARampAndAFlatImage) {
  GrayImage ramp(120, 60);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 120; ++x) ramp.at(x, y) = static_cast<std::uint8_t>(2 * x);
  }
  const GrayImage half = golden::pyramid_down(ramp);
  ASSERT_EQ(half.width, 100);
  ASSERT_EQ(half.height, 50);
  for (int x = 0; x < 100; ++x) EXPECT_NEAR(half.at(x, 7), 2 * (1.2 * x + 0.1), 1.0);
  EXPECT_THAT(golden::pyramid_down(GrayImage(60, 60, 77)).pixels, testing::Each(77));
}

TEST(GoldenFast, ScoresACornerByItsContrastAndAnEdgeNotAtAll) {
  GrayImage corner(21, 21, 50);
  for (int y = 10; y < 21; ++y) {
    for (int x = 10; x < 21; ++x) corner.at(x, y) = 180;
  }
  EXPECT_EQ(golden::fast_score_at(corner, 10, 10), 130);
  GrayImage edge(21, 21, 50);
  for (int y = 0; y < 21; ++y) {
    for (int x = 10; x < 21; ++x) edge.at(x, y) = 180;
  }
  EXPECT_EQ(golden::fast_score_at(edge, 10, 10), 0);
  EXPECT_EQ(golden::fast_score_at(edge, 9, 10), 0);
  EXPECT_EQ(golden::fast_score(corner, 130).at(10, 10), 0) << "not above the threshold";
  EXPECT_EQ(golden::fast_score(corner, 129).at(10, 10), 130);
}

TEST(GoldenBlur, KeepsAFlatImageAndSpreadsAPoint) {
  EXPECT_THAT(golden::gaussian_blur(GrayImage(9, 9, 200)).pixels, testing::Each(200));
  GrayImage point(15, 15);
  point.at(7, 7) = 255;
  const GrayImage blurred = golden::gaussian_blur(point);
  EXPECT_EQ(blurred.at(7, 7), 12);  // 255 * (56 / 256)^2
  EXPECT_EQ(blurred.at(4, 7), blurred.at(10, 7));
  EXPECT_EQ(blurred.at(7, 4), blurred.at(7, 10));
  EXPECT_EQ(blurred.at(11, 7), 0);
}

TEST(GoldenSelect, TakesTheFirstOfEqualNeighboursAndTheBestOfACell) {
  GrayImage score(70, 60);
  score.at(25, 25) = 40;
  score.at(26, 25) = 40;  // right of an equal one: suppressed
  score.at(30, 30) = 50;
  score.at(33, 30) = 10;  // below the high threshold in a cell that has better
  score.at(50, 25) = 10;  // alone in its cell
  const auto slots = golden::select_cells(score, 20, 20);
  EXPECT_EQ(slots[0], golden::corner_key(50, 30, 30));
  EXPECT_EQ(slots[1], golden::corner_key(40, 25, 25));
  EXPECT_EQ(slots[2], 0u);
  EXPECT_EQ(slots[kPerCell], golden::corner_key(10, 50, 25));
}

/// A bright bar that points into `angle` from the centre.
GrayImage bar(double angle) {
  GrayImage image(61, 61, 20);
  for (int y = 0; y < 61; ++y) {
    for (int x = 0; x < 61; ++x) {
      const double dx = x - 30;
      const double dy = y - 30;
      const double along = dx * std::cos(angle) + dy * std::sin(angle);
      const double across = -dx * std::sin(angle) + dy * std::cos(angle);
      if (along > 0 && std::abs(across) < 4) image.at(x, y) = 220;
    }
  }
  return image;
}

TEST(GoldenOrientation, FollowsARotatedShape) {
  for (int bin = 0; bin < kBins; ++bin) {
    const GrayImage image = bar(2 * std::numbers::pi * (bin + 0.5) / kBins);
    const auto [m10, m01] = golden::moments(image, 30, 30);
    EXPECT_EQ(golden::direction_bin(m10, m01), bin);
  }
  EXPECT_EQ(golden::direction_bin(0, 0), 0);
}

TEST(GoldenOrientation, EveryMomentLiesInExactlyOneBin) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const int x = random.between(-600000, 600000);
    const int y = random.between(-600000, 600000);
    const double angle = std::atan2(y, x) + (y < 0 ? 2 * std::numbers::pi : 0);
    const double exact = angle / (2 * std::numbers::pi) * kBins;
    const int bin = golden::direction_bin(x, y);
    EXPECT_NEAR(exact, bin + 0.5, 0.51) << x << ", " << y;
  }
}

TEST(GoldenDescriptor, EqualPatchesAreEqualAndOthersAreHalfApart) {
  const GrayImage texture = golden::gaussian_blur(textured_image({200, 120}, 5));
  const GrayImage moved = moved_image(texture, 11, -4);
  const auto& table = test_table();
  const auto a = golden::describe(texture, 80, 60, 9, table);
  EXPECT_EQ(golden::hamming(a, golden::describe(moved, 91, 56, 9, table)), 0);
  const int other = golden::hamming(a, golden::describe(texture, 130, 50, 9, table));
  EXPECT_GT(other, 70);
  EXPECT_LT(other, 186);
}

TEST(GoldenDescriptor, TurnsWithTheImage) {
  // A quarter turn is exact: eight bins of 32.
  const GrayImage image = golden::gaussian_blur(textured_image({61, 61}, 8));
  GrayImage turned(61, 61);
  for (int y = 0; y < 61; ++y) {
    for (int x = 0; x < 61; ++x) turned.at(60 - y, x) = image.at(x, y);
  }
  const auto& table = test_table();
  const auto a = golden::describe(image, 30, 30, 3, table);
  EXPECT_EQ(golden::hamming(a, golden::describe(turned, 30, 30, 11, table)), 0);
}

TEST(FrontendPattern, StaysInThePatchAndHasNoEqualTests) {
  ASSERT_EQ(test_table().size(), std::size_t{kBins} * kTests * 2);
  for (const std::uint16_t offset : test_table()) {
    EXPECT_LT(offset % kPatchStride, kPatchRows);
    EXPECT_LT(offset / kPatchStride, kPatchRows);
  }
  std::set<std::array<int, 4>> different;
  for (const TestPair& pair : base_pattern()) {
    EXPECT_TRUE(pair.x0 != pair.x1 || pair.y0 != pair.y1);
    different.insert({pair.x0, pair.y0, pair.x1, pair.y1});
  }
  EXPECT_GT(different.size(), 250u);
}

TEST(GoldenMatch, TheRatioTestRefusesTwins) {
  const Keypoint at{100 * 256, 100 * 256, 100 | (100 << 16), 9};
  Keypoint beside = at;
  beside.x_q8 += 256;
  golden::Descriptor descriptor{1, 2, 3, 4, 5, 6, 7, 8};
  golden::Descriptor near = descriptor;
  near[0] ^= 0xFF;
  const std::vector<Keypoint> queries{at};
  const std::vector<Keypoint> trains{at, beside};
  const std::vector<golden::Descriptor> query{descriptor};
  const std::vector<golden::Descriptor> twins{near, near};
  const std::vector<golden::Descriptor> apart{near, golden::Descriptor{}};
  const std::vector<Shift> shifts{Shift{}};
  const Window window{-512, 512, -512, 512};
  const auto match = [&](const auto& trained, int ratio) {
    return golden::match_window(queries, query, shifts, trains, trained, window, 64, ratio)[0];
  };
  EXPECT_EQ(match(twins, 200).index, -1);
  EXPECT_EQ(match(twins, 256), (Match{0, 8})) << "ties go to the smaller index";
  EXPECT_EQ(match(apart, 200), (Match{0, 8}));
}

TEST(GoldenMatch, OfSeveralQueriesTheNearestKeepsTheMatch) {
  const std::vector<Match> matches{{1, 20}, {1, 12}, {-1, kNoDistance}, {1, 12}};
  const auto inverse = golden::invert_matches(matches, 3);
  EXPECT_EQ(inverse[0], Match{});
  EXPECT_EQ(inverse[1], (Match{1, 12}));
}

TEST(GoldenRefine, TheParabolaFindsItsVertex) {
  // Costs of (x - v)^2 times 1000 at -1, 0, 1.
  for (const double v : {-0.4, -0.1, 0.0, 0.25, 0.5}) {
    const auto cost = [v](int x) {
      return static_cast<int>(std::lround(1000 * (x - v) * (x - v)));
    };
    EXPECT_NEAR(golden::parabola_q8(cost(-1), cost(0), cost(1)) / 256.0, v, 0.01);
  }
  EXPECT_EQ(golden::parabola_q8(7, 7, 7), 0);
}

TEST(GoldenRefine, FindsASubPixelShift) {
  // A smooth pattern, moved by 2.3 pixels.
  const auto pattern = [](double x, double y) {
    return static_cast<std::uint8_t>(
        std::lround(128 + 60 * std::sin(x * 0.45) + 50 * std::cos(y * 0.38 + x * 0.1)));
  };
  std::array<GrayImage, 2> a{GrayImage(90, 80), GrayImage(75, 66)};
  std::array<GrayImage, 2> b = a;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 90; ++x) {
      a[0].at(x, y) = pattern(x, y);
      b[0].at(x, y) = pattern(x + 2.3, y);
    }
  }
  const auto keypoint = [](int x, int y) { return Keypoint{x * 256, y * 256, x | (y << 16), 0}; };
  const std::vector<Keypoint> from{keypoint(50, 40)};
  const std::vector<Keypoint> to{keypoint(46, 41)};
  const std::vector<Match> match{{0, 0}};
  const auto refined = golden::refine_sad(a, b, from, to, match, match, {5, 0, true, 3000});
  ASSERT_EQ(refined[0].index, 0);
  EXPECT_NEAR(refined[0].x_q8 / 256.0, 47.7, 0.15);
  EXPECT_EQ(refined[0].y_q8, 40 * 256) << "on the query's row";
  const std::vector<Match> elsewhere{{-1, kNoDistance}};
  EXPECT_EQ(golden::refine_sad(a, b, from, to, match, elsewhere, {})[0], RefinedMatch{});
}

}  // namespace
}  // namespace partita::frontend
