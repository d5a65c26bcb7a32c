// The entry point with random sizes, parameters and contents, the same in every run: each call ends
// in a whole map or in an Error of one line. Meant for the address sanitizer's build, and run in
// every other one too.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/runtime/error.h"
#include "host/tasks/depth/depth.h"
#include "host/tasks/depth/kernels.h"
#include "host/tasks/depth/synthetic.h"
#include "tests/kernels/kernel_tests.h"

namespace partita::depth {
namespace {

using runtime::Variant;
using sensing::GrayImage;

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  int whole(int least, int most) {
    return least + static_cast<int>(engine_() % static_cast<std::uint32_t>(most - least + 1));
  }
  double real(double least, double most) {
    return least + (most - least) * (engine_() / 4294967295.0);
  }
  bool chance(int percent) { return whole(1, 100) <= percent; }

 private:
  std::mt19937 engine_;
};

const runtime::Session& session(Variant variant) {
  static std::array<std::unique_ptr<runtime::Session>, 3> sessions;
  auto& entry = sessions[static_cast<std::size_t>(variant)];
  if (!entry) {
    runtime::SessionOptions options;
    options.variant = variant;
    options.cache_folder = "-";
    entry = std::make_unique<runtime::Session>(tests::source_device(), kernel_specs(), options);
  }
  return *entry;
}

enum class Content { black, blank, noise, foreign, stripes, checkers, plane, swapped, same, count };

GrayImage filled(Size size, const auto& level) {
  GrayImage image(size.width, size.height);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image.at(x, y) = static_cast<std::uint8_t>(level(x, y));
  }
  return image;
}

SyntheticPair pair_of(Content content, Size size, Random& random) {
  const int period = random.whole(2, 12);
  const auto noise = [&](int, int) { return random.whole(0, 255); };
  GrayImage one;
  switch (content) {
    case Content::black:
      return {GrayImage(size.width, size.height), GrayImage(size.width, size.height)};
    case Content::blank:
      return {GrayImage(size.width, size.height, 255), GrayImage(size.width, size.height, 128)};
    case Content::noise:
      one = filled(size, noise);
      return {one, filled(size, noise)};
    case Content::foreign:
      return {synthetic_pair(size, {0, 0, 3}, 1).left, synthetic_pair(size, {0, 0, 3}, 2).left};
    case Content::stripes:
      one = filled(size, [&](int x, int) { return x % period < period / 2 ? 255 : 0; });
      return {one, one};
    case Content::checkers:
      one = filled(size, [&](int x, int y) { return (x / period + y / period) % 2 * 200; });
      return {one, one};
    case Content::same:
      one = filled(size, noise);
      return {one, one};
    default: {
      SyntheticPair pair = synthetic_pair(size, {random.real(0, 0.2), random.real(0, 0.1), 4}, 3);
      if (content == Content::swapped) std::swap(pair.left, pair.right);
      return pair;
    }
  }
}

/// One parameter of three differs from its setting, one of a hundred and fifty is out of its range.
DepthParameters random_parameters(Random& random) {
  DepthParameters parameters = setting(random.chance(50) ? "robotics" : "middlebury");
  for (const Parameter& parameter : parameter_table()) {
    if (!random.chance(33)) continue;
    double value = random.real(parameter.least, parameter.most);
    if (random.chance(30)) value = random.chance(50) ? parameter.least : parameter.most;
    if (random.chance(2)) value = random.chance(50) ? parameter.least - 1 : parameter.most + 1;
    if (parameter.kind != ParameterKind::real) value = std::floor(value);
    parameter.set(parameters, value);
  }
  return parameters;
}

void expect_whole(const DisparityMap& map, Size size, const DepthParameters& parameters,
                  const std::string& what) {
  EXPECT_EQ(map.width, size.width) << what;
  EXPECT_EQ(map.height, size.height) << what;
  ASSERT_EQ(map.values.size(), static_cast<std::size_t>(size.width * size.height)) << what;
  const int largest = *std::max_element(map.values.begin(), map.values.end());
  EXPECT_LE(largest, 256 * parameters.max_disparity) << what;
  EXPECT_EQ(map.too_few_support_points && largest > 0, false) << what;
}

void fuzz(Variant variant, int rounds, int largest_width, int largest_height) {
  Random random(20100 + static_cast<std::uint32_t>(variant));
  int refused = 0;
  for (int round = 0; round < rounds; ++round) {
    const Size size{random.chance(10) ? random.whole(1, 40) : random.whole(32, largest_width),
                    random.chance(10) ? random.whole(1, 20) : random.whole(16, largest_height)};
    const auto content =
        static_cast<Content>(random.whole(0, static_cast<int>(Content::count) - 1));
    DepthParameters parameters = random_parameters(random);
    if (random.chance(90)) {
      parameters.max_disparity = std::min(parameters.max_disparity, std::max(15, size.width - 1));
    }
    const std::string what = fmt::format("{} round {}: {} x {}, content {}", to_string(variant),
                                         round, size.width, size.height, static_cast<int>(content));
    const SyntheticPair pair = pair_of(content, size, random);
    try {
      Depth depth(session(variant), size.width, size.height, parameters);
      const DisparityMap map = depth.process(pair.left, pair.right, round);
      expect_whole(map, size, parameters, what);
      const bool textured = content != Content::black && content != Content::blank;
      if (!textured && parameters.support_texture > 0) {
        EXPECT_EQ(map.density(), 0) << what;
      }
      EXPECT_EQ(depth.process(pair.left, pair.right, round).values, map.values) << what;
    } catch (const DeviceError& error) {
      ADD_FAILURE() << what << ": " << error.what();
    } catch (const Error& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(refused, rounds / 20);
  EXPECT_LT(refused, rounds / 2);
}

TEST(DepthFuzz, CpuVariant) {
  fuzz(Variant::cpu, 400, 260, 140);
}
TEST(DepthFuzz, GpuVariant) {
  fuzz(Variant::gpu, 100, 160, 70);
}
TEST(DepthFuzz, FpgaVariant) {
  fuzz(Variant::fpga, 100, 160, 70);
}

}  // namespace
}  // namespace partita::depth
