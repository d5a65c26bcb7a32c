#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/tasks/sensing/frame.h"
#include "host/tasks/sensing/scenario_math.h"
#include "host/tasks/sensing/scenario_motion.h"
#include "tests/host/io_temp_folder.h"

namespace partita::sensing {
namespace {

using scenario::Motion;
using scenario::MotionState;
using scenario::Vec3;
using ::testing::HasSubstr;

ScenarioOptions small() {
  ScenarioOptions o;
  o.width = 640;
  o.height = 360;
  o.frames = 20;
  return o;
}

std::uint64_t checksum(const GrayImage& image) {
  std::uint64_t sum = 14695981039346656037ULL;  // FNV-1a
  for (const std::uint8_t p : image.pixels) sum = (sum ^ p) * 1099511628211ULL;
  return sum;
}

TEST(ScenarioMath, SineAndCosineAgreeWithTheLibrary) {
  for (double x = -700; x < 700; x += 0.0371) {
    ASSERT_NEAR(scenario::sine(x), std::sin(x), 1e-12) << x;
    ASSERT_NEAR(scenario::cosine(x), std::cos(x), 1e-12) << x;
  }
}

TEST(ScenarioMath, NormalHasMeanZeroAndDeviationOne) {
  double sum = 0;
  double squares = 0;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    const double v = scenario::normal(7, 1, scenario::key(i), 0);
    sum += v;
    squares += v * v;
  }
  EXPECT_NEAR(sum / kCount, 0, 0.03);
  EXPECT_NEAR(squares / kCount, 1, 0.03);
}

/// The rates and forces that the inertial unit reads are the derivatives of the poses.
TEST(ScenarioMotion, InertialReadingsAreDerivativesOfThePoses) {
  const Motion motion(3);
  constexpr double kStep = 1e-4;
  const MotionState world = motion.state(0);
  const auto pose = [&](double t) { return relative_pose(world, motion.state(t)); };
  for (const double t : {0.5, 3.0, 17.3, 60.1}) {
    const MotionState s = motion.state(t);
    const Pose before = pose(t - kStep);
    const Pose now = pose(t);
    const Pose after = pose(t + kStep);
    const Eigen::AngleAxisd turn((before.inverse() * after).linear());
    const Eigen::Vector3d rate = turn.angle() * turn.axis() / (2 * kStep);
    EXPECT_NEAR(rate.x(), s.angular_velocity.x, 1e-5);
    EXPECT_NEAR(rate.y(), s.angular_velocity.y, 1e-5);
    EXPECT_NEAR(rate.z(), s.angular_velocity.z, 1e-5);
    const Eigen::Vector3d acceleration =
        (after.translation() - 2 * now.translation() + before.translation()) / (kStep * kStep);
    const Vec3 down = rotate_back(world.R_world_cam, Vec3{0, 9.81, 0});
    const Eigen::Vector3d gravity(down.x, down.y, down.z);
    const Eigen::Vector3d force = now.linear().transpose() * (acceleration - gravity);
    EXPECT_NEAR(force.x(), s.specific_force.x, 1e-4);
    EXPECT_NEAR(force.y(), s.specific_force.y, 1e-4);
    EXPECT_NEAR(force.z(), s.specific_force.z, 1e-4);
    EXPECT_NEAR((after.translation() - before.translation()).norm() / (2 * kStep), 5.6, 0.2);
  }
}

TEST(ScenarioMotion, TheStreetReallyTurns) {
  const Motion motion(1);
  double largest = 0;
  for (double t = 0; t < 40; t += 0.1) {
    largest = std::max(largest, std::abs(motion.state(t).angular_velocity.y));
  }
  EXPECT_GT(largest, 0.02);
  EXPECT_LT(largest, 0.2);
}

TEST(Scenario, TheSameSeedGivesTheSameBytesInAnyOrder) {
  const auto a = open_scenario(small());
  const auto b = open_scenario(small());
  const Frame late = a->frame(9);
  b->frame(2);
  const Frame again = b->frame(9);
  EXPECT_EQ(late.left, again.left);
  EXPECT_EQ(late.right, again.right);
  EXPECT_EQ(*late.disparity, *again.disparity);
  ASSERT_EQ(late.imu.size(), again.imu.size());
  EXPECT_EQ(late.imu[3].gyro, again.imu[3].gyro);
  ScenarioOptions other = small();
  other.seed = 2;
  EXPECT_NE(open_scenario(other)->frame(9).left, late.left);
}

/// Pins the bytes: a change of compiler, machine or library must not change the pictures. Whoever
/// changes the street on purpose changes these numbers too.
TEST(Scenario, TheBytesAreTheSameOnEveryMachine) {
  const Frame f = open_scenario(small())->frame(5);
  EXPECT_EQ(checksum(f.left), 1223122677966616506ULL);
  EXPECT_EQ(checksum(f.right), 4590020419689373737ULL);
}

TEST(Scenario, ReadingsComeAtTheirRates) {
  const auto s = open_scenario(small());
  std::size_t imu = 0;
  std::size_t gps = 0;
  std::int64_t last = -1;
  for (std::size_t i = 0; i < 11; ++i) {
    const Frame f = s->frame(i);
    for (const ImuSample& r : f.imu) {
      EXPECT_GT(r.timestamp_ns, last);
      EXPECT_LE(r.timestamp_ns, f.timestamp_ns);
      last = r.timestamp_ns;
    }
    imu += f.imu.size();
    gps += f.gps.size();
  }
  EXPECT_EQ(imu, 201U);  // one second, both ends included
  EXPECT_EQ(gps, 6U);
}

TEST(Scenario, FirstPoseIsTheWorldAndPosesAgreeWithFrames) {
  const auto s = open_scenario(small());
  const auto poses = *s->true_poses();
  ASSERT_EQ(poses.size(), 20U);
  EXPECT_TRUE(poses[0].matrix().isApprox(Eigen::Matrix4d::Identity(), 1e-12));
  EXPECT_TRUE(poses[7].matrix().isApprox(s->frame(7).T_world_cam->matrix()));
  EXPECT_NEAR(poses[10].translation().norm(), 5.6, 0.2);
}

/// What the left camera sees at x, the right one sees at x - disparity, unless something hides it.
TEST(Scenario, DisparityExplainsTheRightPicture) {
  const Frame f = open_scenario(small())->frame(4);
  std::size_t compared = 0;
  std::size_t agreeing = 0;
  double sum_left = 0;
  double sum_shifted = 0;
  for (int y = 1; y + 1 < f.left.height; ++y) {
    for (int x = 0; x + 8 < f.left.width; ++x) {
      const float d = f.disparity->at(x, y);
      const float at = static_cast<float>(x) - d;
      if (d <= 0 || at < 0) continue;
      const int x0 = static_cast<int>(at);
      const float w = at - static_cast<float>(x0);
      const float right = (1 - w) * f.right.at(x0, y) + w * f.right.at(x0 + 1, y);
      const float error = std::abs(right - f.left.at(x, y));
      const float shifted = std::abs(static_cast<float>(f.left.at(x, y)) - f.left.at(x + 3, y));
      sum_left += error;
      sum_shifted += shifted;
      ++compared;
      agreeing += error <= 12 ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 100'000U);
  EXPECT_GT(static_cast<double>(agreeing) / static_cast<double>(compared), 0.9);
  EXPECT_LT(sum_left, 0.5 * sum_shifted);  // and the picture is not simply flat
}

TEST(Scenario, DepthAndDisparityAgreeAndReachFromTheRoadToTheSky) {
  const auto s = open_scenario(small());
  const Frame f = s->frame(0);
  const double scale = s->calibration().fx * s->calibration().baseline;
  std::size_t sky = 0;
  for (std::size_t i = 0; i < f.depth->pixels.size(); ++i) {
    const float depth = f.depth->pixels[i];
    sky += depth == 0 ? 1 : 0;
    if (depth == 0) continue;
    ASSERT_NEAR(f.disparity->pixels[i], scale / depth, 1e-3 * scale / depth);
  }
  EXPECT_GT(sky, f.depth->pixels.size() / 50);
  EXPECT_LT(sky, f.depth->pixels.size() / 2);
  // Straight below the horizon lies the road, a camera's height down; springs and pitch move it.
  const int bottom = 359;
  const double expected = 1.65 * s->calibration().fy / (bottom - s->calibration().cy);
  EXPECT_NEAR(f.depth->at(320, bottom), expected, 0.05 * expected);
}

TEST(Scenario, BoxesHoldRoadUsersOfAllClasses) {
  const auto s = open_scenario(small());
  const Frame f = s->frame(0);
  std::size_t classes[3] = {};
  for (const ObjectBox& b : *f.boxes) {
    ++classes[static_cast<std::size_t>(b.object_class)];
    EXPECT_GE(b.x, 0);
    EXPECT_GE(b.y, 0);
    EXPECT_LE(b.x + b.width, 640);
    EXPECT_LE(b.y + b.height, 360);
    EXPECT_GT(b.visible, 0);
    EXPECT_LE(b.visible, 1);
    if (b.visible < 0.95 || b.distance < 5) continue;
    // Nothing hides it: the depth at some pixel of its box is near its distance.
    bool found = false;
    for (int y = static_cast<int>(b.y); y < b.y + b.height; ++y) {
      for (int x = static_cast<int>(b.x); x < b.x + b.width; ++x) {
        found = found || std::abs(f.depth->at(x, y) - b.distance) < 2.6;
      }
    }
    EXPECT_TRUE(found) << b.id;
  }
  EXPECT_GT(classes[0], 3U);
  EXPECT_GT(classes[1], 2U);
  EXPECT_GT(classes[2], 0U);
}

/// An object keeps its id, so that its box moves little from one frame to the next.
TEST(Scenario, ObjectsKeepTheirIds) {
  const auto s = open_scenario(small());
  const Frame a = s->frame(3);
  const Frame b = s->frame(4);
  std::size_t followed = 0;
  for (const ObjectBox& p : *a.boxes) {
    for (const ObjectBox& q : *b.boxes) {
      if (p.id != q.id) continue;
      ++followed;
      EXPECT_EQ(p.object_class, q.object_class);
      EXPECT_NEAR(p.distance, q.distance, 1.7);  // at most 13.6 m/s against each other
    }
  }
  EXPECT_GT(followed, 8U);
}

TEST(Scenario, RefusesImpossibleOptions) {
  const auto message = [](auto change) {
    ScenarioOptions o;
    change(o);
    return testing::error_of([&] { open_scenario(o); });
  };
  EXPECT_THAT(message([](auto& o) { o.frames = 0; }), HasSubstr("frames is 0"));
  EXPECT_THAT(message([](auto& o) { o.width = 1; }), HasSubstr("width is 1"));
  EXPECT_THAT(message([](auto& o) { o.height = 99999; }), HasSubstr("height"));
  EXPECT_THAT(message([](auto& o) { o.rate_hz = -1; }), HasSubstr("rate"));
  EXPECT_THAT(testing::error_of([] { open_scenario(small())->frame(20); }),
              HasSubstr("no frame 20"));
}

}  // namespace
}  // namespace partita::sensing
