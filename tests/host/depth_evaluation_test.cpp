// The measures of a disparity map by hand-made maps, and points in space.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/runtime/error.h"
#include "host/tasks/depth/evaluation.h"
#include "host/tasks/depth/point_cloud.h"

namespace partita::depth {
namespace {

using sensing::FloatImage;
using sensing::GrayImage;

FloatImage row(std::vector<float> values) {
  FloatImage image(static_cast<int>(values.size()), 1);
  image.pixels = std::move(values);
  return image;
}

TEST(Evaluation, CountsByTheDefinitions) {
  const float none = std::numeric_limits<float>::infinity();
  //                              exact  1 off  1.25 off  3 off  3.5 off  missing  no truth (twice)
  const FloatImage truth = row({10, 10, 10, 10, 10, 10, 0, none});
  const FloatImage map = row({10, 11, 8.75F, 13, 6.5F, 0, 5, 5});
  const Evaluation e = evaluate(map, truth);
  EXPECT_EQ(e.with_truth, 6u);
  EXPECT_EQ(e.compared, 5u);
  EXPECT_EQ(e.over_1, 3u);  // one pixel off is not more than one pixel off
  EXPECT_EQ(e.over_3, 1u);
  EXPECT_DOUBLE_EQ(e.density(), 5.0 / 6);
  EXPECT_DOUBLE_EQ(e.bad1_percent(), 60);
  EXPECT_DOUBLE_EQ(e.bad3_percent(), 20);
  EXPECT_DOUBLE_EQ(e.mean_error_px(), (0 + 1 + 1.25 + 3 + 3.5) / 5);
  EXPECT_DOUBLE_EQ(e.bad1_or_missing_percent(), 100.0 * 4 / 6);
  EXPECT_DOUBLE_EQ(e.bad3_or_missing_percent(), 100.0 * 2 / 6);
}

TEST(Evaluation, AMaskLeavesPixelsOut) {
  const FloatImage truth = row({10, 10, 10});
  const FloatImage map = row({10, 20, 0});
  GrayImage mask(3, 1, 255);
  mask.at(1, 0) = 0;
  const Evaluation e = evaluate(map, truth, &mask);
  EXPECT_EQ(e.with_truth, 2u);
  EXPECT_EQ(e.compared, 1u);
  EXPECT_EQ(e.over_3, 0u);
}

TEST(Evaluation, SeveralMapsAddUp) {
  Evaluation sum = evaluate(row({1, 2}), row({1, 4}));
  sum += evaluate(row({0, 9}), row({5, 4}));
  EXPECT_EQ(sum.with_truth, 4u);
  EXPECT_EQ(sum.compared, 3u);
  EXPECT_EQ(sum.over_1, 2u);
  EXPECT_EQ(sum.over_3, 1u);
  EXPECT_DOUBLE_EQ(sum.mean_error_px(), (0 + 2 + 5) / 3.0);
}

TEST(Evaluation, NothingToCompareIsZeroAndNoNan) {
  const Evaluation e = evaluate(row({0, 0}), row({0, 3}));
  EXPECT_EQ(e.density(), 0);
  EXPECT_EQ(e.bad1_percent(), 0);
  EXPECT_EQ(e.mean_error_px(), 0);
  EXPECT_EQ(e.bad1_or_missing_percent(), 100);
  EXPECT_EQ(Evaluation{}.bad1_or_missing_percent(), 0);
}

TEST(Evaluation, SizesMustBeEqual) {
  EXPECT_THROW(evaluate(row({1}), row({1, 2})), Error);
  const GrayImage mask(2, 2);
  EXPECT_THROW(evaluate(row({1}), row({1}), &mask), Error);
}

TEST(PointCloud, ProjectsBackOntoItsPixels) {
  sensing::PairCalibration calibration;
  calibration.camera = {.fx = 700, .fy = 710, .cx = 2, .cy = 1, .baseline = 0.5};
  calibration.disparity_offset = 30;
  FloatImage map(5, 3);
  map.at(4, 2) = 5;
  map.at(0, 0) = 40;
  GrayImage left(5, 3, 9);
  left.at(4, 2) = 77;
  const PointCloud cloud = point_cloud(map, left, calibration);
  ASSERT_EQ(cloud.points.size(), 2u);
  const io::CloudPoint& p = cloud.points[1];
  EXPECT_FLOAT_EQ(p.z, 700 * 0.5F / 35);
  EXPECT_FLOAT_EQ(700 * p.x / p.z + 2, 4);
  EXPECT_FLOAT_EQ(710 * p.y / p.z + 1, 2);
  EXPECT_EQ(p.gray, 77);
  EXPECT_EQ(cloud.too_far, 0u);
}

TEST(PointCloud, WhatIsTooFarIsCounted) {
  sensing::PairCalibration calibration;
  calibration.camera = {.fx = 700, .fy = 700, .cx = 2, .cy = 0, .baseline = 0.5};
  const PointCloud cloud = point_cloud(row({0, 0.5F, 1}), GrayImage(3, 1), calibration);
  EXPECT_EQ(cloud.points.size(), 1u);
  EXPECT_EQ(cloud.too_far, 1u);
}

}  // namespace
}  // namespace partita::depth
