// The whole front-end on PoCL: on synthetic pairs in every variant, on bad input, and on the real
// sequence against its ground truth.
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/runtime/error.h"
#include "host/tasks/frontend/cases.h"
#include "host/tasks/frontend/frontend.h"
#include "host/tasks/frontend/kernels.h"
#include "tests/kernels/kernel_tests.h"

namespace partita::frontend {
namespace {

using runtime::Variant;

runtime::Session session_for(Variant variant) {
  runtime::SessionOptions options;
  options.variant = variant;
  return {tests::source_device(), kernel_specs(), options};
}

StereoCalibration calibration_of(Size size) {
  return {400, 400, size.width / 2.0, size.height / 2.0, 0.5, size.width, size.height};
}

/// A fronto-parallel textured wall: disparity 16 in the first frame; the camera then moves
/// sideways, so that the picture moves to the left by three pixels per frame.
struct Wall {
  Size size{320, 200};
  GrayImage texture = textured_image({400, 200}, 21);

  GrayImage seen(int offset) const {
    GrayImage image(size.width, size.height);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) image.at(x, y) = texture.at(x + offset, y);
    }
    return image;
  }
  GrayImage left(int frame) const { return seen(3 * frame); }
  GrayImage right(int frame) const { return seen(3 * frame + 16); }
};

void expect_message(const std::function<void()>& call, const std::string& part) {
  try {
    call();
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(part));
  }
}

class FrontendVariants : public testing::TestWithParam<Variant> {};

TEST_P(FrontendVariants, FollowsACameraAlongAWall) {
  const Wall wall;
  const auto session = session_for(GetParam());
  Frontend frontend(session, calibration_of(wall.size));
  const FrontendResult first = frontend.process(wall.left(0), wall.right(0), 0);
  EXPECT_TRUE(first.first);
  EXPECT_GT(first.stereo_matches, 50);
  for (const Feature& feature : first.features) {
    if (feature.disparity > 0) {
      EXPECT_NEAR(feature.disparity, 16, 1.0);
    }
  }
  for (int frame = 1; frame < 5; ++frame) {
    const FrontendResult result = frontend.process(wall.left(frame), wall.right(frame), frame);
    EXPECT_TRUE(result.tracked);
    EXPECT_EQ(result.reference, frame - 1);
    EXPECT_GT(result.inliers, result.temporal_matches / 2);
    // Depth 400 * 0.5 / 16 = 12.5 m, three pixels: 0.09375 m to the right per frame; before a plane
    // that and a turn look much the same, hence the bounds.
    EXPECT_NEAR(result.T_world_cam.translation().x(), 0.09375 * frame, 0.06);
    EXPECT_NEAR(result.T_world_cam.translation().z(), 0, 0.15);
  }
}

TEST_P(FrontendVariants, WarmUpLeavesNoTrace) {
  const Wall wall;
  const auto session = session_for(GetParam());
  Frontend warm(session, calibration_of(wall.size));
  warm.warm_up();
  Frontend cold(session, calibration_of(wall.size));
  for (int frame = 0; frame < 2; ++frame) {
    const auto a = warm.process(wall.left(frame), wall.right(frame), frame);
    const auto b = cold.process(wall.left(frame), wall.right(frame), frame);
    EXPECT_EQ(a.T_world_cam.matrix(), b.T_world_cam.matrix());
    EXPECT_EQ(a.keypoints_left, b.keypoints_left);
  }
}

INSTANTIATE_TEST_SUITE_P(All, FrontendVariants, testing::ValuesIn(runtime::kVariants),
                         [](const auto& test) { return std::string(to_string(test.param)); });

TEST(FrontendTask, FeaturesSpreadOverTheImageAndStayWithinTheirNumber) {
  const Size size{640, 360};
  const GrayImage left = textured_image(size, 4);
  const auto session = session_for(Variant::cpu);
  FrontendParameters parameters;
  parameters.max_features = 500;
  Frontend frontend(session, calibration_of(size), parameters);
  const auto result = frontend.process(left, moved_image(left, -9, 0), 0);
  EXPECT_LE(result.keypoints_left, 500);
  EXPECT_GT(result.keypoints_left, 250);
  std::array<int, 16> parts{};
  std::array<int, 2> levels{};
  for (const Feature& feature : result.features) {
    const int column = static_cast<int>(feature.x) * 4 / size.width;
    const int row = static_cast<int>(feature.y) * 4 / size.height;
    ++parts[static_cast<std::size_t>(row * 4 + column)];
    ++levels[static_cast<std::size_t>(feature.level)];
  }
  EXPECT_THAT(parts, testing::Each(testing::Ge(8)));
  EXPECT_GT(levels[0], levels[1]);
  EXPECT_GT(levels[1], 50);
}

TEST(FrontendTask, LowContrastCellsFallBackToTheLowerThreshold) {
  const Size size{320, 200};
  GrayImage image = textured_image(size, 6);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width / 2; ++x) {
      image.at(x, y) = static_cast<std::uint8_t>(100 + image.at(x, y) / 16);
    }
  }
  const auto session = session_for(Variant::cpu);
  const auto in_left_half = [&](int low) {
    FrontendParameters parameters;
    parameters.fast_threshold_low = low;
    Frontend frontend(session, calibration_of(size), parameters);
    const auto result = frontend.process(image, image, 0);
    return std::count_if(result.features.begin(), result.features.end(),
                         [](const Feature& feature) { return feature.x < 130; });
  };
  EXPECT_EQ(in_left_half(20), 0);
  EXPECT_GT(in_left_half(4), 50);
}

TEST(FrontendTask, ABlackFrameIsPassedOver) {
  const Wall wall;
  const auto session = session_for(Variant::cpu);
  Frontend frontend(session, calibration_of(wall.size));
  for (int frame = 0; frame < 3; ++frame) {
    frontend.process(wall.left(frame), wall.right(frame), frame);
  }
  const GrayImage black(wall.size.width, wall.size.height);
  const auto lost = frontend.process(black, black, 3);
  EXPECT_FALSE(lost.tracked);
  EXPECT_FALSE(lost.first);
  EXPECT_EQ(lost.keypoints_left, 0);
  EXPECT_NEAR(lost.T_world_cam.translation().x(), 3 * 0.09375, 0.06) << "the motion goes on";
  const auto found = frontend.process(wall.left(4), wall.right(4), 4);
  EXPECT_TRUE(found.tracked);
  EXPECT_EQ(found.reference, 2);
  EXPECT_NEAR(found.T_world_cam.translation().x(), 4 * 0.09375, 0.06);
}

TEST(FrontendTask, BlackFromTheStart) {
  const Wall wall;
  const GrayImage black(wall.size.width, wall.size.height);
  const auto session = session_for(Variant::cpu);
  Frontend frontend(session, calibration_of(wall.size));
  EXPECT_TRUE(frontend.process(black, black, 0).first);
  const auto second = frontend.process(black, black, 1);
  EXPECT_FALSE(second.tracked);
  EXPECT_TRUE(second.T_world_cam.isApprox(Pose::Identity()));
}

TEST(FrontendTask, RefusesWhatItCannotUse) {
  const auto session = session_for(Variant::cpu);
  expect_message([&] { Frontend(session, calibration_of({63, 200})); }, "63 x 200");
  expect_message([&] { Frontend(session, calibration_of({5000, 200})); }, "5000 x 200");
  StereoCalibration calibration = calibration_of({320, 200});
  calibration.baseline = 0;
  expect_message([&] { Frontend(session, calibration); }, "baseline");
  FrontendParameters parameters;
  parameters.max_features = 3000;
  expect_message(
      [&] {
        Frontend(session, calibration_of({320, 200}), parameters);
      },
      "max_features is 3000, expected 64 to 2048");
  parameters = {};
  parameters.inlier_bound = std::nan("");
  expect_message(
      [&] {
        Frontend(session, calibration_of({320, 200}), parameters);
      },
      "inlier_bound");

  const Wall wall;
  Frontend frontend(session, calibration_of(wall.size));
  expect_message([&] { frontend.process(wall.left(0), GrayImage(319, 200), 0); },
                 "right image of 319 x 200, expected 320 x 200");
  frontend.process(wall.left(0), wall.right(0), 7);
  expect_message([&] { frontend.process(wall.left(1), wall.right(1), 7); },
                 "frame 7 after frame 7");
}

TEST(FrontendTask, TheSmallestImageWorks) {
  const Size size{64, 64};
  const GrayImage image = textured_image(size, 3);
  const auto session = session_for(Variant::cpu);
  Frontend frontend(session, calibration_of(size));
  EXPECT_TRUE(frontend.process(image, image, 0).first);
  EXPECT_FALSE(frontend.process(image, image, 1).first);
}

class FrontendSequence : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("PARTITA_DATA");
    if (data == nullptr) GTEST_SKIP() << "PARTITA_DATA is not set";
    source_ = sensing::open_kitti(std::string(data) + "/seq_kitti_odom_1");
  }
  std::vector<FrontendResult> run(Variant variant, std::size_t frames) {
    const auto session = session_for(variant);
    Frontend frontend(session, source_->calibration());
    std::vector<FrontendResult> results;
    for (std::size_t i = 0; i < frames; ++i) {
      const sensing::Frame frame = source_->frame(i);
      results.push_back(frontend.process(frame.left, frame.right, static_cast<std::int64_t>(i)));
    }
    return results;
  }
  std::unique_ptr<sensing::FrameSource> source_;
};

TEST_F(FrontendSequence, EndErrorIsBelowOnePercent) {
  const auto results = run(Variant::cpu, source_->size());
  const auto truth = source_->true_poses().value();
  double distance = 0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    distance += (truth[i].translation() - truth[i - 1].translation()).norm();
    EXPECT_TRUE(results[i].tracked) << i;
    EXPECT_FALSE(i > 1 && results[i].widened) << i;
    EXPECT_GT(results[i].inliers, 100) << i;
  }
  const double error =
      (results.back().T_world_cam.translation() - truth.back().translation()).norm();
  EXPECT_LT(error / distance, 0.01) << error << " m of " << distance << " m";
}

TEST_F(FrontendSequence, TheTrajectoryIsTheSameInEveryVariant) {
  constexpr std::size_t kFrames = 8;
  const auto cpu = run(Variant::cpu, kFrames);
  for (const Variant variant : {Variant::gpu, Variant::fpga}) {
    const auto other = run(variant, kFrames);
    for (std::size_t i = 0; i < kFrames; ++i) {
      EXPECT_EQ(other[i].T_world_cam.matrix(), cpu[i].T_world_cam.matrix())
          << to_string(variant) << " frame " << i;
      EXPECT_EQ(other[i].stereo_matches, cpu[i].stereo_matches);
      EXPECT_EQ(other[i].temporal_matches, cpu[i].temporal_matches);
    }
  }
}

}  // namespace
}  // namespace partita::frontend
