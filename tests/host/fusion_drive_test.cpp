// The estimator on drives: a made one with a bend, braking and a stop, whose truth is exact;
// EuRoC's unit at rest and its propagation between true states; a real car's gaps.
#include <algorithm>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "host/runtime/error.h"
#include "host/tasks/fusion/drive.h"
#include "host/tasks/sensing/dataset.h"

namespace partita::fusion {
namespace {

/// Rest for 3 s, off to 12 m/s, a bend of 90 degrees to the left while braking to 5 m/s, off again.
class MadeDrive {
 public:
  explicit MadeDrive(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const auto noise = [&](double sigma) -> Vector3d {
      return Vector3d(normal(random), normal(random), normal(random)) * sigma;
    };
    const Vector3d gyro_bias(0.003, -0.002, 0.004), accel_bias(0.05, -0.08, 0.1);
    double x = 0, y = 0, yaw = 0.6, speed = 0;
    constexpr double h = 0.001;
    for (int k = 0; k < 45000; ++k) {
      const double t = k * h;
      const double a = acceleration(t), w = turn(t);
      const auto ns = static_cast<std::int64_t>(k) * 1'000'000;
      if (k % 10 == 0) {
        const Vector3d force(a, w * speed, kGravity);
        log.imu.push_back(
            {ns, Vector3d(0, 0, w) + gyro_bias + noise(0.003), force + accel_bias + noise(0.05)});
        sensing::TimedPose pose;
        pose.timestamp_ns = ns;
        pose.T_world_imu.linear() = so3::exp({0, 0, yaw});
        pose.T_world_imu.translation() = Vector3d(x, y, 0);
        log.truth.push_back(pose);
      }
      if (k % 200 == 0) {
        log.gps.push_back({ns, Vector3d(x, y, 0) + noise(0.8), 0.8});
      }
      x += speed * std::cos(yaw) * h;
      y += speed * std::sin(yaw) * h;
      yaw += w * h;
      speed += a * h;
    }
    log.R_imu_vehicle = Matrix3d::Identity();
  }
  static double acceleration(double t) {
    if (t < 3 || t > 40) return 0;
    if (t < 9) return 2;
    if (t >= 25 && t < 29) return -1.75;
    return t >= 33 && t < 36 ? 1.5 : 0;
  }
  static double turn(double t) { return t >= 26 && t < 32 ? 1.5708 / 6 : 0; }
  Vector3d truth(std::int64_t ns) const {
    const auto at = std::lower_bound(
        log.truth.begin(), log.truth.end(), ns,
        [](const sensing::TimedPose& p, std::int64_t t) { return p.timestamp_ns < t; });
    return (at == log.truth.end() ? log.truth.back() : *at).T_world_imu.translation();
  }
  double worst(const DriveResult& result, double from, double until) const {
    double worst = 0;
    for (const NavState& s : result.states) {
      const double t = static_cast<double>(s.timestamp_ns) * 1e-9;
      if (t < from || t > until) continue;
      const double off = (s.position - truth(s.timestamp_ns)).head<2>().norm();
      if (!(off <= worst)) worst = off;  // not finite is the worst
    }
    return worst;
  }
  SensorLog log;
};

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(FusionDrive, AGapWithBrakingAndABendIsBridged) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const MadeDrive drive(seed);
    const GpsGap gap{24 * kSecond, 34 * kSecond};
    const DriveResult result = localize(drive.log, {}, options_for(drive.log), std::span(&gap, 1));
    EXPECT_STREQ(result.origin, "at rest");
    ASSERT_TRUE(result.in_map);
    EXPECT_GE(result.counts.longest_gps_gap, 10);
    EXPECT_LT(drive.worst(result, 15, 24), 3.5);
    EXPECT_LT(drive.worst(result, 24, 34.5), 6.0);
    EXPECT_LT(drive.worst(result, 36, 45), 2.5);
    EXPECT_EQ(result.counts.unsolved, 0U);
    // The fixes after the gap are believed at once.
    for (const FixReport& report : result.fixes) {
      if (report.fix.timestamp_ns < 15 * kSecond) continue;
      EXPECT_EQ(report.verdict, FixReport::Verdict::used) << report.fix.timestamp_ns;
    }
  }
}

TEST(FusionDrive, RestGivesGravityBiasAndNoVelocity) {
  const MadeDrive drive(4);
  Estimator estimator(options_for(drive.log));
  std::vector<ImuSample> first(drive.log.imu.begin(), drive.log.imu.begin() + 250);
  estimator.add_imu(first);
  std::optional<NavState> state;
  for (int k = 1; k <= 24; ++k) state = estimator.step({.timestamp_ns = k * kSecond / 10});
  ASSERT_TRUE(state);
  EXPECT_LT((state->bias.gyro - Vector3d(0.003, -0.002, 0.004)).norm(), 1e-3);
  EXPECT_LT(state->velocity.norm(), 0.02);
  EXPECT_GT(estimator.counts().standstill, 5U);
  EXPECT_LT(std::acos((state->R_world_imu.transpose() * Vector3d::UnitZ()).z()), 0.02);
}

TEST(FusionDrive, AFixAKilometreOffIsRejectedAndCounted) {
  MadeDrive drive(5);
  std::size_t moved = 0;
  for (sensing::GpsFix& fix : drive.log.gps) {
    if (fix.timestamp_ns < 20 * kSecond || ++moved % 10 != 0) continue;
    fix.position += Vector3d(1000, -300, 0);
  }
  const DriveResult result = localize(drive.log, {}, options_for(drive.log));
  EXPECT_EQ(result.counts.fixes_rejected, moved / 10);
  EXPECT_EQ(result.counts.relocations, 0U);
  EXPECT_LT(drive.worst(result, 15, 45), 2.5);
  for (const FixReport& report : result.fixes) {
    if (report.verdict == FixReport::Verdict::rejected) EXPECT_GT(report.sigmas, 100);
  }
}

TEST(FusionDrive, ManyFixesThatAgreeMoveTheEstimate) {
  MadeDrive drive(6);
  for (sensing::GpsFix& fix : drive.log.gps) {
    if (fix.timestamp_ns >= 20 * kSecond) fix.position += Vector3d(300, 0, 0);
  }
  const DriveResult result = localize(drive.log, {}, options_for(drive.log));
  EXPECT_EQ(result.counts.relocations, 1U);
  const NavState& last = result.states.back();
  EXPECT_LT((last.position - drive.truth(last.timestamp_ns) - Vector3d(300, 0, 0)).head<2>().norm(),
            3.0);
}

TEST(FusionDrive, MissingReadingsAreBridgedAndTold) {
  MadeDrive drive(7);
  std::erase_if(drive.log.imu, [](const ImuSample& s) {
    return s.timestamp_ns > 20 * kSecond && s.timestamp_ns < 20 * kSecond + kSecond / 2;
  });
  const DriveResult result = localize(drive.log, {}, options_for(drive.log));
  EXPECT_NEAR(result.counts.bridged_seconds, 0.5, 0.05);
  EXPECT_LT(drive.worst(result, 15, 45), 3.0);
}

TEST(FusionDrive, TheSameReadingsGiveTheSameBits) {
  const MadeDrive drive(8);
  const DriveResult a = localize(drive.log, {}, options_for(drive.log));
  const DriveResult b = localize(drive.log, {}, options_for(drive.log));
  ASSERT_EQ(a.states.size(), b.states.size());
  EXPECT_EQ(a.states.back().position, b.states.back().position);
}

class FusionData : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("PARTITA_DATA");
    if (folder == nullptr) GTEST_SKIP() << "PARTITA_DATA names no folder";
    data_ = folder;
  }
  std::string data_;
};

TEST_F(FusionData, EurocAtRestIsFoundSo) {
  const sensing::Dataset euroc = sensing::open_dataset(data_ + "/seq_euroc_v101_static");
  ASSERT_GT(euroc.log.truth.size(), 1000U);
  ASSERT_EQ(euroc.frames->size(), 20U);
  const auto second =
      std::find_if(euroc.log.imu.begin(), euroc.log.imu.end(), [&](const ImuSample& s) {
        return s.timestamp_ns >= euroc.log.imu.front().timestamp_ns + kSecond;
      });
  const std::span first(euroc.log.imu.begin(), second);
  const Rest rest = observe_rest(first);
  ASSERT_TRUE(rest.steady);
  const Initial initial =
      initialise_at_rest(rest, euroc.log.imu.front().timestamp_ns, euroc.log.noise);
  const sensing::TimedPose& truth = euroc.log.truth.front();
  EXPECT_LT((initial.state.bias.gyro - *truth.gyro_bias).norm(), 3e-3);
  EXPECT_EQ(initial.state.velocity.norm(), 0);
  const Vector3d up = initial.state.R_world_imu.transpose() * Vector3d::UnitZ();
  const Vector3d true_up = truth.T_world_imu.linear().transpose() * Vector3d::UnitZ();
  EXPECT_LT(std::acos(up.dot(true_up)), 0.02);
}

/// From each true state (velocity and biases are the truth's too), one second by readings alone.
TEST_F(FusionData, EurocPropagationMatchesTheTruth) {
  const sensing::Dataset euroc = sensing::open_dataset(data_ + "/seq_euroc_v101_static");
  const auto& truth = euroc.log.truth;
  std::vector<double> position, rotation;
  for (std::size_t i = 0; i + 20 < truth.size(); i += 20) {
    const sensing::TimedPose& a = truth[i];
    const sensing::TimedPose& b = truth[i + 20];
    NavState state{a.timestamp_ns,
                   a.T_world_imu.linear(),
                   a.T_world_imu.translation(),
                   *a.velocity,
                   {*a.gyro_bias, *a.accel_bias}};
    Preintegration motion(state.bias, euroc.log.noise);
    motion.integrate(euroc.log.imu, a.timestamp_ns, b.timestamp_ns);
    const NavState end = motion.predict(state);
    position.push_back((end.position - b.T_world_imu.translation()).norm());
    rotation.push_back(so3::log(end.R_world_imu.transpose() * b.T_world_imu.linear()).norm());
  }
  std::sort(position.begin(), position.end());
  std::sort(rotation.begin(), rotation.end());
  RecordProperty("position_median_mm", static_cast<int>(1e3 * position[position.size() / 2]));
  EXPECT_LT(position[position.size() / 2], 0.03);
  EXPECT_LT(position[position.size() * 9 / 10], 0.08);
  EXPECT_LT(rotation[rotation.size() / 2], 0.005);
  EXPECT_LT(rotation[rotation.size() * 9 / 10], 0.02);
}

TEST_F(FusionData, ARealCarsGapsAreBridged) {
  const sensing::Dataset car = sensing::open_dataset(data_ + "/imu_gps/2014-02-14-002-Data.csv");
  const auto gaps = all_gaps(car.log, options_for(car.log), 10, 4);
  ASSERT_GT(gaps.size(), 40U);
  const auto within =
      std::count_if(gaps.begin(), gaps.end(), [](const GapError& gap) { return gap.error <= 10; });
  EXPECT_GE(static_cast<double>(within), 0.9 * static_cast<double>(gaps.size()));
}

}  // namespace
}  // namespace partita::fusion
