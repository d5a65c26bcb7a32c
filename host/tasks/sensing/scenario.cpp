// The built-in scenario as a source of frames.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/tasks/sensing/dataset.h"
#include "host/tasks/sensing/drive_csv.h"
#include "host/tasks/sensing/frame.h"
#include "host/tasks/sensing/scenario_motion.h"
#include "host/tasks/sensing/scenario_raster.h"
#include "host/tasks/sensing/scenario_street.h"
#include "host/tasks/sensing/scenario_textures.h"

namespace partita::sensing {

namespace {

using namespace scenario;  // NOLINT(google-build-using-namespace): this file is its front door

constexpr double kBaseline = 0.5;
constexpr double kFocalPerWidth = 700.0 / 1280.0;
constexpr std::uint64_t kSensorNoise = 401;
constexpr double kLeastVisible = 0.08;  // of a road user, for it to have a box
constexpr int kLeastHeight = 8;         // pixels

void check(const ScenarioOptions& o) {
  const auto refuse = [](const char* key, auto value, const char* expected) {
    throw Error(fmt::format("scenario: {} is {}, expected {}", key, value, expected));
  };
  if (o.frames < 1 || o.frames > 100'000) refuse("frames", o.frames, "1 to 100000");
  if (o.width < 64 || o.width > 4096) refuse("width", o.width, "64 to 4096");
  if (o.height < 64 || o.height > 4096) refuse("height", o.height, "64 to 4096");
  if (!(o.rate_hz >= 1 && o.rate_hz <= 200)) refuse("rate", o.rate_hz, "1 to 200 Hz");
}

StereoCalibration calibration_of(const ScenarioOptions& o) {
  StereoCalibration c;
  c.fx = kFocalPerWidth * o.width;
  c.fy = c.fx;
  c.cx = 0.5 * (o.width - 1);
  c.cy = 0.5 * (o.height - 1);
  c.baseline = kBaseline;
  c.width = o.width;
  c.height = o.height;
  return c;
}

class Scenario final : public FrameSource {
 public:
  explicit Scenario(const ScenarioOptions& options)
      : options_(options),
        calibration_(calibration_of(options)),
        textures_(options.seed),
        motion_(options.seed) {}

  std::string name() const override { return fmt::format("scenario (seed {})", options_.seed); }
  const StereoCalibration& calibration() const override { return calibration_; }
  std::size_t size() const override { return options_.frames; }
  std::int64_t timestamp_ns(std::size_t index) const override {
    return static_cast<std::int64_t>(
        std::floor(static_cast<double>(index) * (1e9 / options_.rate_hz) + 0.5));
  }
  Frame frame(std::size_t index) const override;
  std::optional<std::vector<Pose>> true_poses() const override {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < size(); ++i) poses.push_back(pose(state(i)));
    return poses;
  }

 private:
  double seconds(std::size_t index) const {
    return static_cast<double>(timestamp_ns(index)) * 1e-9;
  }
  MotionState state(std::size_t index) const { return motion_.state(seconds(index)); }
  Pose pose(const MotionState& s) const { return relative_pose(motion_.state(0.0), s); }
  void add_readings(Frame& f) const;
  void add_truth(Frame& f, const World& world, const View& view, const Picture& left) const;

  ScenarioOptions options_;
  StereoCalibration calibration_;
  TextureSet textures_;
  Motion motion_;
};

Frame Scenario::frame(std::size_t index) const {
  if (index >= size())
    throw Error(fmt::format("{}: no frame {}, it has {}", name(), index, size()));
  Frame f;
  f.index = index;
  f.timestamp_ns = timestamp_ns(index);
  const MotionState s = state(index);
  const World world = build_world(motion_.street(), textures_, options_.seed, seconds(index));
  const View left_view{s.position, s.R_world_cam, calibration_};
  const View right_view{s.position + s.R_world_cam.x * kBaseline, s.R_world_cam, calibration_};
  Picture left = draw(world.scene, left_view, hash(options_.seed, kSensorNoise, index, 0));
  f.right = draw(world.scene, right_view, hash(options_.seed, kSensorNoise, index, 1)).gray;
  f.T_world_cam = pose(s);
  add_truth(f, world, left_view, left);
  f.left = std::move(left.gray);
  add_readings(f);
  return f;
}

void Scenario::add_readings(Frame& f) const {
  const std::int64_t before = f.index > 0 ? timestamp_ns(f.index - 1) : -1;
  for (std::int64_t k = before < 0 ? 0 : before / Motion::kImuPeriodNs + 1;
       k * Motion::kImuPeriodNs <= f.timestamp_ns; ++k) {
    f.imu.push_back(motion_.imu(k));
  }
  for (std::int64_t k = before < 0 ? 0 : before / Motion::kGpsPeriodNs + 1;
       k * Motion::kGpsPeriodNs <= f.timestamp_ns; ++k) {
    f.gps.push_back(motion_.gps(k));
  }
}

void Scenario::add_truth(Frame& f, const World& world, const View& view,
                         const Picture& left) const {
  f.depth = FloatImage(calibration_.width, calibration_.height);
  f.disparity = *f.depth;
  const auto scale = static_cast<float>(calibration_.fx * kBaseline);
  for (std::size_t i = 0; i < left.inverse_depth.size(); ++i) {
    const float w = left.inverse_depth[i];
    f.depth->pixels[i] = w > 0 ? 1.0F / w : 0.0F;
    f.disparity->pixels[i] = scale * w;
  }
  f.boxes.emplace();
  const std::vector<Silhouette> shapes = silhouettes(world.scene, view, left, world.users.size());
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Silhouette& s = shapes[i];
    if (s.visible == 0 || s.bottom - s.top + 1 < kLeastHeight) continue;
    const double visible = static_cast<double>(s.visible) / static_cast<double>(s.pixels);
    if (visible < kLeastVisible) continue;
    const RoadUser& user = world.users[i];
    const double distance = rotate_back(view.R_world_cam, user.centre - view.position).z;
    f.boxes->push_back({user.object_class, user.id, static_cast<double>(s.left),
                        static_cast<double>(s.top), static_cast<double>(s.right - s.left + 1),
                        static_cast<double>(s.bottom - s.top + 1), distance, visible, s.truncated});
  }
  std::sort(f.boxes->begin(), f.boxes->end(),
            [](const ObjectBox& a, const ObjectBox& b) { return a.id < b.id; });
}

/// The readings that all frames together carry.
SensorLog scenario_log(const FrameSource& frames, const Motion& motion) {
  SensorLog log;
  const std::int64_t end = frames.timestamp_ns(frames.size() - 1);
  for (std::int64_t k = 0; k * Motion::kImuPeriodNs <= end; ++k) log.imu.push_back(motion.imu(k));
  for (std::int64_t k = 0; k * Motion::kGpsPeriodNs <= end; ++k) log.gps.push_back(motion.gps(k));
  log.R_imu_vehicle = vehicle_in_camera_axes();
  const std::vector<Pose> poses = *frames.true_poses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    log.truth.push_back({frames.timestamp_ns(i), poses[i], {}, {}, {}});
  }
  return log;
}

}  // namespace

Dataset open_scenario_drive(const ScenarioOptions& options) {
  Dataset dataset;
  dataset.kind = "scenario";
  dataset.frames = open_scenario(options);
  dataset.log = scenario_log(*dataset.frames, Motion(options.seed));
  measure_noise(dataset.log);
  return dataset;
}

std::unique_ptr<FrameSource> open_scenario(const ScenarioOptions& options) {
  check(options);
  return std::make_unique<Scenario>(options);
}

}  // namespace partita::sensing
