// Tracker on PoCL: a moving patch, tracks made, kept and ended, the same bytes in all variants, and
// the benchmark sequences of PARTITA_DATA.
#include <cmath>
#include <cstdlib>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/io/boxes.h"
#include "host/io/image.h"
#include "host/io/sequence.h"
#include "host/runtime/error.h"
#include "host/tasks/tracking/accuracy.h"
#include "host/tasks/tracking/kernels.h"
#include "host/tasks/tracking/tracker.h"
#include "tests/kernels/kernel_tests.h"

namespace partita::tracking {
namespace {

using ::testing::HasSubstr;

runtime::Session make_session(runtime::Variant variant) {
  runtime::SessionOptions options;
  options.variant = variant;
  options.cache_folder = "-";
  return {tests::source_device(), kernel_specs(), options};
}
const runtime::Session& cpu_session() {
  static const runtime::Session session = make_session(runtime::Variant::cpu);
  return session;
}

/// A blurred random texture, `side` pixels across.
sensing::GrayImage texture(int side, unsigned seed, int blur) {
  std::mt19937 random(seed);
  sensing::GrayImage noise(side, side), image(side, side);
  for (auto& v : noise.pixels) v = static_cast<std::uint8_t>(random() % 256);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      image.at(x, y) = noise.at(x / blur * blur, y / blur * blur);
    }
  }
  return image;
}

/// A target of `side` pixels at (x, y) before a background of its own.
sensing::GrayImage scene(double x, double y, int side, unsigned seed = 1) {
  sensing::GrayImage image = texture(200, 99, 8);
  const sensing::GrayImage target = texture(40, seed, 5);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const int tx = static_cast<int>(std::floor((u - x) * 40 / side));
      const int ty = static_cast<int>(std::floor((v - y) * 40 / side));
      if (tx >= 0 && ty >= 0 && tx < 40 && ty < 40) image.at(u, v) = target.at(tx, ty);
    }
  }
  return image;
}

std::optional<std::span<const Detection>> some(const std::vector<Detection>& detections) {
  return std::span<const Detection>(detections);
}

TEST(Tracker, FollowsAMovingPatchThatGrows) {
  Tracker tracker(cpu_session(), 200, 200);
  tracker.update(scene(40, 60, 30), some({{{40, 60, 30, 30}, 1, 0}}));
  for (int k = 1; k <= 25; ++k) {
    const double x = 40 + 2.5 * k, y = 60 + 1.5 * k;
    const int side = 30 + k / 2;
    tracker.update(scene(x, y, side));
    ASSERT_EQ(tracker.tracks().size(), 1u) << k;
    EXPECT_GT(overlap(tracker.tracks()[0].box, {x, y, 1.0 * side, 1.0 * side}), 0.7) << k;
    EXPECT_EQ(tracker.tracks()[0].id, 1);
  }
}

TEST(Tracker, GivesTheSameInAllVariants) {
  std::vector<std::vector<Track>> last;
  for (const runtime::Variant variant : runtime::kVariants) {
    const runtime::Session session = make_session(variant);
    Tracker tracker(session, 200, 200);
    const std::vector<Detection> first{{{40, 60, 30, 30}, 0.9, 2}, {{130, 20, 44, 50}, 0.8, 0}};
    tracker.update(scene(40, 60, 30), some(first));
    for (int k = 1; k <= 4; ++k) tracker.update(scene(40 + 2 * k, 60 + k, 30));
    last.push_back(tracker.tracks());
  }
  ASSERT_EQ(last[0].size(), 2u);
  for (std::size_t v = 1; v < last.size(); ++v) {
    for (std::size_t t = 0; t < 2; ++t) {
      EXPECT_EQ(last[v][t].box, last[0][t].box);  // to the last bit
      EXPECT_EQ(last[v][t].response, last[0][t].response);
    }
  }
}

TEST(Tracker, MakesKeepsAndEndsTracks) {
  TrackerParameters parameters;
  parameters.patience = 1;
  parameters.capacity = 2;
  Tracker tracker(cpu_session(), 200, 200, parameters);
  const Box a{40, 60, 30, 30}, b{130, 110, 30, 40}, c{10, 150, 30, 30};
  const sensing::GrayImage image = scene(40, 60, 30);
  tracker.update(image, some({{a, 0.9, 1}, {b, 0.9, 1}, {c, 0.9, 1}, {c, 0.1, 1}}));
  ASSERT_EQ(tracker.tracks().size(), 2u);
  EXPECT_EQ(tracker.refused(), 1);  // no place for c; its second detection is too weak anyway
  // In another order, and of another class: the ids stay.
  tracker.update(image, some({{b, 0.7, 5}, {a, 0.8, 1}}));
  ASSERT_EQ(tracker.tracks().size(), 2u);
  EXPECT_EQ(tracker.tracks()[0].id, 1);
  EXPECT_EQ(tracker.tracks()[0].box, a);
  EXPECT_EQ(tracker.tracks()[1].label, 5);
  // A frame without a detector is no miss; two frames with one are one too many.
  tracker.update(image);
  EXPECT_EQ(tracker.tracks()[1].misses, 0);
  tracker.update(image, some({{a, 0.8, 1}}));
  EXPECT_EQ(tracker.tracks().size(), 2u);
  tracker.update(image, some({{a, 0.8, 1}}));
  ASSERT_EQ(tracker.tracks().size(), 1u);
  ASSERT_EQ(tracker.ended().size(), 1u);
  EXPECT_EQ(tracker.ended()[0].track.id, 2);
  EXPECT_EQ(tracker.ended()[0].why, End::missed);
  // Its place is free, its id is not used again.
  tracker.update(image, some({{a, 0.8, 1}, {c, 0.9, 1}}));
  ASSERT_EQ(tracker.tracks().size(), 2u);
  EXPECT_EQ(tracker.tracks()[1].id, 3);
  // None at all.
  tracker.update(image, some({}));
  tracker.update(image, some({}));
  EXPECT_TRUE(tracker.tracks().empty());
  tracker.update(image);
  EXPECT_EQ(tracker.counts(), FrameCounts{});
}

TEST(Tracker, ATargetThatLeavesThePictureEnds) {
  Tracker tracker(cpu_session(), 200, 200);
  tracker.update(scene(150, 80, 30), some({{{150, 80, 30, 30}, 1, 0}}));
  int k = 1;
  for (; k < 20 && !tracker.tracks().empty(); ++k) tracker.update(scene(150 + 4.0 * k, 80, 30));
  ASSERT_TRUE(tracker.tracks().empty());
  EXPECT_EQ(tracker.ended()[0].why, End::left_picture);
  EXPECT_GT(k, 7);  // after 20 / 4 pictures it touches the edge, after 50 / 4 nothing is left
  EXPECT_LT(k, 15);
}

TEST(Tracker, BadInputIsNamed) {
  const auto error_of = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  Tracker tracker(cpu_session(), 200, 200);
  const sensing::GrayImage image(200, 200);
  const auto box_error = [&](const Box& box) {
    return error_of([&] { tracker.update(image, some({{box, 1, 0}})); });
  };
  EXPECT_THAT(box_error({10, 10, 0, 20}), HasSubstr("too small"));
  EXPECT_THAT(box_error({10, 10, 20, -5}), HasSubstr("too small"));
  EXPECT_THAT(box_error({300, 10, 20, 20}), HasSubstr("outside the picture"));
  EXPECT_THAT(box_error({-18, 10, 20, 20}), HasSubstr("outside the picture"));
  EXPECT_THAT(box_error({0, 0, 201, 20}), HasSubstr("larger than the picture"));
  EXPECT_THAT(box_error({std::nan(""), 0, 20, 20}), HasSubstr("not finite"));
  EXPECT_THAT(error_of([&] { tracker.update(sensing::GrayImage(100, 200)); }),
              HasSubstr("100 x 200, expected 200 x 200"));
  const auto parameter_error = [&](auto change) {
    TrackerParameters parameters;
    change(parameters);
    return error_of([&] { Tracker(cpu_session(), 200, 200, parameters); });
  };
  EXPECT_THAT(parameter_error([](auto& p) { p.filter.scales = 4; }), HasSubstr("odd"));
  EXPECT_THAT(parameter_error([](auto& p) { p.filter.template_side = 60; }),
              HasSubstr("64 or 128"));
  EXPECT_THAT(parameter_error([](auto& p) { p.filter.sigma = std::nan(""); }), HasSubstr("sigma"));
  EXPECT_THAT(parameter_error([](auto& p) { p.capacity = 0; }), HasSubstr("capacity"));
  EXPECT_THAT(error_of([&] { Tracker(cpu_session(), 8, 200); }), HasSubstr("width"));
}

struct Sequence {
  const char* folder;
  double mean_overlap, precision;
};

class TrackerData : public ::testing::TestWithParam<Sequence> {};

TEST_P(TrackerData, ReachesItsAccuracy) {
  const char* data = std::getenv("PARTITA_DATA");
  if (data == nullptr) GTEST_SKIP() << "PARTITA_DATA is not set: no real sequences to track";
  const std::string folder = fmt::format("{}/track/{}", data, GetParam().folder);
  const auto truth = io::read_boxes(folder + "/groundtruth_rect.txt");
  const auto pictures = io::list_pictures(folder);
  ASSERT_EQ(pictures.size(), truth.size());
  std::optional<Tracker> tracker;
  std::vector<std::optional<Box>> boxes;
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const sensing::GrayImage image = io::read_gray(pictures[k]).image;
    if (!tracker) {
      tracker.emplace(cpu_session(), image.width, image.height);
      tracker->update(image, some({{*truth[0], 1, 0}}));
    } else {
      tracker->update(image);
    }
    if (tracker->tracks().empty()) break;
    boxes.emplace_back(tracker->tracks()[0].box);
  }
  const Accuracy accuracy = measure(boxes, truth);
  fmt::print("{}: mean IoU {:.3f}, precision at 20 px {:.3f}\n", GetParam().folder,
             accuracy.mean_overlap, accuracy.precision);
  EXPECT_GE(accuracy.mean_overlap, GetParam().mean_overlap);
  EXPECT_GE(accuracy.precision, GetParam().precision);
}

INSTANTIATE_TEST_SUITE_P(Sequences, TrackerData,
                         ::testing::Values(Sequence{"Crossing", 0.70, 1.0},
                                           Sequence{"uav_truck4_1", 0.40, 0.80}),
                         [](const auto& test) { return std::string(test.param.folder); });

}  // namespace
}  // namespace partita::tracking
