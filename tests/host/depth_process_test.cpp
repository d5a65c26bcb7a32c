// The whole task on made-up pictures: what is put in comes out, the same from every variant; and
// bad input does not crash.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/runtime/error.h"
#include "host/tasks/depth/depth.h"
#include "host/tasks/depth/kernels.h"
#include "host/tasks/depth/synthetic.h"
#include "tests/kernels/kernel_tests.h"

namespace partita::depth {
namespace {

using runtime::Session;
using runtime::Variant;

constexpr Size kSize{211, 120};

/// One session per variant for all tests: building takes longer than running.
const Session& session(Variant variant) {
  static std::array<std::unique_ptr<Session>, 3> sessions;
  auto& entry = sessions[static_cast<std::size_t>(variant)];
  if (!entry) {
    runtime::SessionOptions options;
    options.variant = variant;
    options.cache_folder = "-";
    entry = std::make_unique<Session>(tests::source_device(), kernel_specs(), options);
  }
  return *entry;
}

DisparityMap run(Variant variant, const SyntheticPair& pair, DepthParameters parameters = {}) {
  Depth depth(session(variant), pair.left.width, pair.left.height, parameters);
  return depth.process(pair.left, pair.right, 0);
}

/// Share of the pixels whose disparity is off by more than `limit`, among those that have one.
double share_off(const DisparityMap& map, const SyntheticPlane& plane, double limit) {
  int valid = 0;
  int off = 0;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      if (!map.valid(x, y)) continue;
      ++valid;
      off += std::abs(map.pixels(x, y) - plane.at(x, y)) > limit;
    }
  }
  return valid == 0 ? 1.0 : static_cast<double>(off) / valid;
}

TEST(DepthProcess, RecoversAConstantShift) {
  const SyntheticPlane plane{0, 0, 11};
  const DisparityMap map = run(Variant::cpu, synthetic_pair(kSize, plane, 5));
  EXPECT_FALSE(map.too_few_support_points);
  EXPECT_GT(map.density(), 0.85);
  // Between whole pixels the parabola decides, whose sides need not be equally steep.
  EXPECT_LT(share_off(map, plane, 0.5), 0.02);
}

TEST(DepthProcess, RecoversASlantedPlaneToTheNearestDisparity) {
  const SyntheticPlane plane{0.05, 0.04, 6};
  const DisparityMap map = run(Variant::cpu, synthetic_pair(kSize, plane, 6));
  EXPECT_GT(map.density(), 0.8);
  EXPECT_LT(share_off(map, plane, 0.75), 0.03);
  EXPECT_LT(share_off(map, plane, 1.5), 0.01);
}

TEST(DepthProcess, AllVariantsGiveTheSameMap) {
  const SyntheticPair pair = synthetic_pair(kSize, {0.05, 0.04, 6}, 7);
  for (const int last : {31, 127}) {
    DepthParameters parameters;
    parameters.max_disparity = last;
    const DisparityMap cpu = run(Variant::cpu, pair, parameters);
    EXPECT_EQ(cpu.values, run(Variant::gpu, pair, parameters).values);
    EXPECT_EQ(cpu.values, run(Variant::fpga, pair, parameters).values);
  }
}

TEST(DepthProcess, AllVariantsFillThePictureInTheMiddleburySetting) {
  const SyntheticPlane plane{0.05, 0.04, 6};
  const SyntheticPair pair = synthetic_pair(kSize, plane, 7);
  const DisparityMap cpu = run(Variant::cpu, pair, setting("middlebury"));
  EXPECT_EQ(cpu.density(), 1);
  EXPECT_LT(share_off(cpu, plane, 1.5), 0.1);
  EXPECT_EQ(cpu.values, run(Variant::gpu, pair, setting("middlebury")).values);
  EXPECT_EQ(cpu.values, run(Variant::fpga, pair, setting("middlebury")).values);
}

TEST(DepthProcess, SpecklesGoAndASurfaceStays) {
  DepthParameters parameters;  // that believe anything
  parameters.support_threshold = 1;
  parameters.incon_min_support = 1;
  parameters.lr_threshold = 255;
  parameters.filter_adaptive_mean = false;
  std::mt19937 random(3);
  SyntheticPair noise{{kSize.width, kSize.height}, {kSize.width, kSize.height}};
  for (auto* image : {&noise.left, &noise.right}) {
    for (std::uint8_t& pixel : image->pixels) pixel = static_cast<std::uint8_t>(random());
  }
  const auto density = [&](const SyntheticPair& pair, int speckle_size) {
    parameters.speckle_size = speckle_size;
    return run(Variant::cpu, pair, parameters).density();
  };
  EXPECT_GT(density(noise, 0), 0.9);
  EXPECT_LT(density(noise, 200), 0.2);
  EXPECT_GT(density(synthetic_pair(kSize, {0, 0, 11}, 5), 200), 0.8);
}

TEST(DepthProcess, AFrameDoesNotDependOnTheOneBefore) {
  const SyntheticPair first = synthetic_pair(kSize, {0, 0, 20}, 1);
  const SyntheticPair second = synthetic_pair(kSize, {0.05, 0.04, 6}, 2);
  Depth depth(session(Variant::cpu), kSize.width, kSize.height, {});
  depth.warm_up();
  depth.process(first.left, first.right, 0);
  EXPECT_EQ(depth.process(second.left, second.right, 1).values, run(Variant::cpu, second).values);
}

TEST(DepthProcess, BlankPicturesGiveAnEmptyMap) {
  for (const int grey : {0, 128, 255}) {
    const sensing::GrayImage blank(kSize.width, kSize.height, static_cast<std::uint8_t>(grey));
    for (const Variant variant : runtime::kVariants) {
      const DisparityMap map = run(variant, {blank, blank});
      EXPECT_TRUE(map.too_few_support_points);
      EXPECT_EQ(map.counts.support_points, 0);
      EXPECT_EQ(map.density(), 0);
    }
  }
}

TEST(DepthProcess, SwappedPicturesDoNotCrash) {
  SyntheticPair pair = synthetic_pair(kSize, {0, 0, 11}, 5);
  std::swap(pair.left, pair.right);
  EXPECT_LT(run(Variant::cpu, pair).density(), 0.5);
}

TEST(DepthProcess, OddSizesAndTheSmallestOne) {
  DepthParameters parameters;
  parameters.max_disparity = 15;
  for (const Size size : {Size{32, 16}, Size{33, 17}, Size{61, 16}, Size{47, 95}}) {
    const SyntheticPair pair = synthetic_pair(size, {0, 0, 4}, 9);
    const DisparityMap cpu = run(Variant::cpu, pair, parameters);
    EXPECT_EQ(cpu.values, run(Variant::gpu, pair, parameters).values);
    EXPECT_EQ(cpu.values, run(Variant::fpga, pair, parameters).values);
  }
}

sensing::GrayImage random_picture(Size size, std::mt19937& random) {
  sensing::GrayImage image(size.width, size.height);
  const unsigned kind = random() % 3;  // noise, a pattern that repeats, a step
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int value = kind == 0   ? static_cast<int>(random())
                        : kind == 1 ? (x % 7) * 36 + y % 5
                                    : (x > size.width / 2 ? 255 : 0);
      image.at(x, y) = static_cast<std::uint8_t>(value);
    }
  }
  return image;
}

TEST(DepthProcess, RandomSizesParametersAndContentsGiveOneMap) {
  std::mt19937 random(11);
  const auto between = [&](int least, int most) {
    return least + static_cast<int>(random() % static_cast<unsigned>(most - least + 1));
  };
  for (int round = 0; round < 24; ++round) {
    const Size size{between(32, 260), between(16, 90)};
    DepthParameters p;
    p.max_disparity = between(15, std::min(255, size.width - 1));
    p.candidate_step = between(5, 12);
    p.support_threshold = between(50, 100) / 100.0;
    p.support_texture = between(0, 200);
    p.lr_threshold = between(0, 4);
    p.incon_window = between(1, 16);
    p.incon_min_support = between(1, 8);
    p.redun_max_distance = between(1, 16);
    p.beta = between(1, 1000) / 1000.0;
    p.gamma = between(1, 1000) / 100.0;
    p.sigma = between(1, 80) / 10.0;
    p.grid_size = between(8, 64);
    p.match_texture = between(0, 200);
    p.add_corners = between(0, 1) != 0;
    p.speckle_size = between(0, 400);
    p.speckle_similarity = between(0, 4);
    p.ipol_gap_width = between(0, 1) != 0 ? between(0, 9) : 5000;
    p.filter_adaptive_mean = between(0, 1) != 0;
    p.filter_median = between(0, 1) != 0;
    const SyntheticPair pair =
        round % 2 == 0 ? synthetic_pair(size, {0.03, 0.05, 5}, random())
                       : SyntheticPair{random_picture(size, random), random_picture(size, random)};
    const DisparityMap cpu = run(Variant::cpu, pair, p);
    EXPECT_EQ(cpu.values, run(Variant::gpu, pair, p).values) << round;
    EXPECT_EQ(cpu.values, run(Variant::fpga, pair, p).values) << round;
  }
}

/// The message of the Error that the call throws.
template <typename Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(DepthBadInput, IsRefusedInOneLine) {
  using testing::HasSubstr;
  const Session& s = session(Variant::cpu);
  const auto make = [&](int width, int height, auto change) {
    return message_of([&] {
      DepthParameters parameters;
      change(parameters);
      Depth depth(s, width, height, parameters);
    });
  };
  const auto nothing = [](DepthParameters&) {};
  EXPECT_THAT(make(31, 100, nothing), HasSubstr("31 x 100"));
  EXPECT_THAT(make(100, 15, nothing), HasSubstr("at least 32 x 16"));
  EXPECT_THAT(make(0, 0, nothing), HasSubstr("0 x 0"));
  EXPECT_THAT(make(-5, 100, nothing), HasSubstr("-5 x 100"));
  EXPECT_THAT(make(100, 100, nothing), HasSubstr("max_disparity is 127"));
  EXPECT_THAT(make(300, 100, [](auto& p) { p.max_disparity = 256; }), HasSubstr("15 to 255"));
  EXPECT_THAT(make(300, 100, [](auto& p) { p.candidate_step = 0; }), HasSubstr("candidate_step"));
  EXPECT_THAT(make(300, 100, [](auto& p) { p.beta = std::nan(""); }), HasSubstr("beta"));
  EXPECT_THAT(make(300, 100, [](auto& p) { p.gamma = 0; }), HasSubstr("gamma"));
  EXPECT_THAT(make(300, 100, [](auto& p) { p.incon_window = 17; }), HasSubstr("incon_window"));

  Depth depth(s, kSize.width, kSize.height, {});
  const sensing::GrayImage right_size(kSize.width, kSize.height);
  const sensing::GrayImage other_size(kSize.width, kSize.height + 1);
  EXPECT_THAT(message_of([&] { depth.process(right_size, other_size, 3); }),
              HasSubstr("frame 3: right picture"));
  EXPECT_THAT(message_of([&] { depth.process(other_size, right_size, 3); }),
              HasSubstr("left picture is 211 x 121"));
  EXPECT_THAT(message_of([&] { depth.process({}, right_size, 3); }), HasSubstr("0 x 0"));
}

TEST(DepthBadInput, FpgaHasAWidestPicture) {
  EXPECT_THAT(message_of([&] { Depth depth(session(Variant::fpga), 1601, 100, {}); }),
              testing::HasSubstr("1600"));
}

}  // namespace
}  // namespace partita::depth
