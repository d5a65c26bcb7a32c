// EuRoC's ASL folders (Burri et al., "The EuRoC micro aerial vehicle datasets", IJRR 2016):
//   mav0/cam0, cam1   sensor.yaml (intrinsics, distortion, T_BS), data.csv, data/*.png
//   mav0/imu0         sensor.yaml (noise, T_BS), data.csv
//   mav0/state_groundtruth_estimate0/*.csv   optional; T_BS in its sensor.yaml must be the identity
// The body B is the inertial unit. Pictures are rectified as they are read.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "host/io/csv.h"
#include "host/io/file.h"
#include "host/io/image.h"
#include "host/runtime/error.h"
#include "host/tasks/sensing/dataset.h"
#include "host/tasks/sensing/drive_csv.h"
#include "host/tasks/sensing/rectify.h"
#include "host/tasks/sensing/sensor_files.h"
#include "host/tasks/sensing/synchronise.h"

namespace partita::sensing {
namespace {

namespace fs = std::filesystem;

/// OpenCV's YAML begins with "%YAML:1.0", which no other reader takes.
YAML::Node read_yaml(const fs::path& path) {
  std::string text = io::read_file(path.string());
  if (text.starts_with("%YAML")) text.replace(0, std::min(text.find('\n'), text.size()), "");
  try {
    YAML::Node node = YAML::Load(text);
    if (!node.IsMap()) throw Error(fmt::format("{}: no keys, expected a sensor's", path.string()));
    return node;
  } catch (const YAML::Exception& error) {
    // The message may quote the file's own bytes, a line's end among them.
    const std::string message = error.msg.substr(0, error.msg.find_first_of("\r\n"));
    throw Error(fmt::format("{}:{}: {}", path.string(), error.mark.line + 1, message));
  }
}

std::vector<double> numbers(const fs::path& path, const YAML::Node& node, const std::string& key,
                            std::size_t count) {
  std::vector<double> values;
  try {
    if (node[key]) values = node[key].as<std::vector<double>>();
  } catch (const YAML::Exception& error) {
    throw Error(fmt::format("{}:{}: {}: not numbers", path.string(), error.mark.line + 1, key));
  }
  const bool finite = std::all_of(values.begin(), values.end(),
                                  [](double v) { return std::isfinite(v) && std::abs(v) < 1e9; });
  if (values.size() != count || !finite) {
    throw Error(fmt::format("{}: {} has {} numbers, expected {} finite ones", path.string(), key,
                            values.size(), count));
  }
  return values;
}

Pose read_T_BS(const fs::path& path, const YAML::Node& node) {
  const YAML::Node T = node["T_BS"];
  if (!T || !T.IsMap()) throw Error(fmt::format("{}: no T_BS", path.string()));
  const std::vector<double> v = numbers(path, T, "data", 16);
  Pose pose = Pose::Identity();
  for (int i = 0; i < 12; ++i) pose.matrix()(i / 4, i % 4) = v[static_cast<std::size_t>(i)];
  const Eigen::Matrix3d R = pose.linear();
  if (!((R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-3) ||
      R.determinant() < 0) {
    throw Error(fmt::format("{}: T_BS: the 3x3 part is not a rotation", path.string()));
  }
  pose.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  return pose;
}

struct EurocCamera {
  RawCamera raw;
  Pose T_imu_cam = Pose::Identity();
};

EurocCamera read_camera(const fs::path& path) {
  const YAML::Node node = read_yaml(path);
  EurocCamera camera;
  camera.T_imu_cam = read_T_BS(path, node);
  const auto intrinsics = numbers(path, node, "intrinsics", 4);
  const auto distortion = numbers(path, node, "distortion_coefficients", 4);
  const auto resolution = numbers(path, node, "resolution", 2);
  const bool sane = intrinsics[0] > 1 && intrinsics[1] > 1 && resolution[0] >= 16 &&
                    resolution[1] >= 16 && resolution[0] <= 8192 && resolution[1] <= 8192;
  if (!sane) throw Error(fmt::format("{}: no camera's intrinsics and resolution", path.string()));
  RawCamera& raw = camera.raw;
  raw.fx = intrinsics[0];
  raw.fy = intrinsics[1];
  raw.cx = intrinsics[2];
  raw.cy = intrinsics[3];
  raw.distortion = {distortion[0], distortion[1], distortion[2], distortion[3], 0};
  raw.width = static_cast<int>(resolution[0]);
  raw.height = static_cast<int>(resolution[1]);
  return camera;
}

ImuNoise read_noise(const fs::path& path) {
  const YAML::Node node = read_yaml(path);
  if (!read_T_BS(path, node).isApprox(Pose::Identity(), 1e-9)) {
    throw Error(
        fmt::format("{}: T_BS is not the identity, expected the unit as the body", path.string()));
  }
  const auto density = [&](const char* key, double usual) {
    if (!node[key]) return usual;
    double value = 0;
    try {
      value = node[key].as<double>();
    } catch (const YAML::Exception&) {
    }
    if (!(value > 0 && value < 10)) {
      throw Error(fmt::format("{}: {}: expected a density above 0", path.string(), key));
    }
    return value;
  };
  ImuNoise noise;
  // The data sheet's densities do not know of motors; in flight the noise is several times that.
  constexpr double kInUse = 5;
  noise.gyro_density = kInUse * density("gyroscope_noise_density", 1.7e-4);
  noise.accel_density = kInUse * density("accelerometer_noise_density", 2e-3);
  noise.gyro_walk = density("gyroscope_random_walk", 2e-5);
  noise.accel_walk = density("accelerometer_random_walk", 3e-3);
  noise.gyro_bias = 0.1;
  noise.accel_bias = 0.2;
  return noise;
}

struct Picture {
  std::int64_t timestamp_ns = 0;
  fs::path file;
};

std::vector<Picture> read_pictures(const fs::path& camera, std::vector<std::string>& notices) {
  const io::CsvFile list((camera / "data.csv").string());
  std::vector<Picture> pictures;
  std::size_t absent = 0;
  for (std::size_t row = 0; row < list.rows(); ++row) {
    const auto time = list.whole(row, 0);
    if (!time || *time < 0) list.fail(row, "expected a time in nanoseconds and a file's name");
    if (!pictures.empty() && *time <= pictures.back().timestamp_ns) {
      list.fail(row, "the time does not increase");
    }
    const std::string name(list.cell(row, 1));
    if (name.empty() || name.find('/') != name.npos) list.fail(row, "no file's name");
    const fs::path file = camera / "data" / name;
    if (fs::exists(file)) {
      pictures.push_back({*time, file});
    } else {
      ++absent;
    }
  }
  if (absent > 0) {
    notices.push_back(
        fmt::format("{}: {} of its {} pictures are not there", list.path(), absent, list.rows()));
  }
  return pictures;
}

class EurocSource final : public FrameSource {
 public:
  EurocSource(const fs::path& folder, SensorLog& log) : folder_(folder) {
    const EurocCamera left = read_camera(folder / "cam0" / "sensor.yaml");
    const EurocCamera right = read_camera(folder / "cam1" / "sensor.yaml");
    if (left.raw.width != right.raw.width || left.raw.height != right.raw.height) {
      throw Error(fmt::format("{}: the two cameras differ in size", folder.string()));
    }
    const Rectification r =
        rectify(left.raw, right.raw, left.T_imu_cam.inverse() * right.T_imu_cam);
    if (!(r.calibration.baseline > 1e-3)) {
      throw Error(
          fmt::format("{}: both cameras at one place, expected a base line", folder.string()));
    }
    calibration_ = r.calibration;
    left_map_ = std::make_unique<RectifyMap>(left.raw, r.R_rect_left, calibration_);
    right_map_ = std::make_unique<RectifyMap>(right.raw, r.R_rect_right, calibration_);
    Pose T_cam_rect = Pose::Identity();
    T_cam_rect.linear() = r.R_rect_left.transpose();
    log.T_imu_cam = left.T_imu_cam * T_cam_rect;
    pair_up(read_pictures(folder / "cam0", notices_), read_pictures(folder / "cam1", notices_));
  }

  std::string name() const override { return folder_.string(); }
  const StereoCalibration& calibration() const override { return calibration_; }
  std::size_t size() const override { return pairs_.size(); }
  std::int64_t timestamp_ns(std::size_t i) const override { return pairs_.at(i).timestamp_ns; }
  std::vector<std::string> notices() const override { return notices_; }
  Frame frame(std::size_t index) const override {
    const Pair& pair = pairs_.at(index);
    Frame f;
    f.index = index;
    f.timestamp_ns = pair.timestamp_ns;
    f.left = read(pair.left, *left_map_);
    f.right = read(pair.right, *right_map_);
    return f;
  }

 private:
  struct Pair {
    std::int64_t timestamp_ns = 0;
    fs::path left, right;
  };

  static GrayImage read(const fs::path& path, const RectifyMap& map) {
    try {
      return map.apply(io::read_gray(path.string()).image);
    } catch (const Error& error) {
      const std::string text = error.what();
      if (text.starts_with(path.string())) throw;
      throw Error(fmt::format("{}: {}", path.string(), text));
    }
  }

  void pair_up(const std::vector<Picture>& left, const std::vector<Picture>& right) {
    std::size_t alone = 0, j = 0;
    for (const Picture& picture : left) {
      while (j < right.size() && right[j].timestamp_ns < picture.timestamp_ns - kSyncToleranceNs) {
        ++j;
        ++alone;
      }
      if (j == right.size() || right[j].timestamp_ns > picture.timestamp_ns + kSyncToleranceNs) {
        ++alone;
        continue;
      }
      pairs_.push_back({picture.timestamp_ns, picture.file, right[j++].file});
    }
    if (alone > 0) {
      notices_.push_back(
          fmt::format("{}: {} pictures without their partner left out", folder_.string(), alone));
    }
  }

  fs::path folder_;
  StereoCalibration calibration_;
  std::unique_ptr<RectifyMap> left_map_, right_map_;
  std::vector<Pair> pairs_;
  std::vector<std::string> notices_;
};

std::vector<TimedPose> read_truth(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code code;
  for (auto it = fs::directory_iterator(folder, code); !code && it != fs::directory_iterator();
       it.increment(code)) {
    if (it->path().extension() == ".csv") files.push_back(it->path());
  }
  if (files.empty()) return {};
  std::sort(files.begin(), files.end());
  const io::CsvFile csv(files.front().string());
  const auto column = [&csv](std::initializer_list<std::string_view> names) {
    const auto found = csv.find(names);
    if (found) return *found;
    throw Error(fmt::format("{}: no column '{}', expected EuRoC's ground truth", csv.path(),
                            *names.begin()));
  };
  const std::size_t time = column({"timestamp", "time"});
  const std::size_t p[3] = {column({"p_rs_r_x", "px"}), column({"p_rs_r_y", "py"}),
                            column({"p_rs_r_z", "pz"})};
  const std::size_t q[4] = {column({"q_rs_w", "qw"}), column({"q_rs_x", "qx"}),
                            column({"q_rs_y", "qy"}), column({"q_rs_z", "qz"})};
  const auto vector =
      [&csv](std::size_t row, std::initializer_list<std::string_view> x,
             std::initializer_list<std::string_view> y,
             std::initializer_list<std::string_view> z) -> std::optional<Eigen::Vector3d> {
    const auto cx = csv.find(x), cy = csv.find(y), cz = csv.find(z);
    if (!cx || !cy || !cz) return std::nullopt;
    const auto vx = csv.value(row, *cx), vy = csv.value(row, *cy), vz = csv.value(row, *cz);
    if (!vx || !vy || !vz) return std::nullopt;
    return Eigen::Vector3d(*vx, *vy, *vz);
  };
  std::vector<TimedPose> truth;
  for (std::size_t row = 0; row < csv.rows(); ++row) {
    TimedPose pose;
    const auto ns = csv.whole(row, time);
    if (!ns) csv.fail(row, "expected a time in nanoseconds");
    pose.timestamp_ns = *ns;
    double values[7];
    for (int i = 0; i < 7; ++i) {
      const auto value = csv.value(row, i < 3 ? p[i] : q[i - 3]);
      if (!value) csv.fail(row, "a pose with a number missing");
      values[i] = *value;
    }
    const Eigen::Quaterniond rotation(values[3], values[4], values[5], values[6]);
    if (!(std::abs(rotation.norm() - 1) < 1e-2)) {
      csv.fail(row, "the quaternion is not of length 1");
    }
    pose.T_world_imu.linear() = rotation.normalized().toRotationMatrix();
    pose.T_world_imu.translation() = Eigen::Vector3d(values[0], values[1], values[2]);
    pose.velocity = vector(row, {"v_rs_r_x", "vx"}, {"v_rs_r_y", "vy"}, {"v_rs_r_z", "vz"});
    pose.gyro_bias =
        vector(row, {"b_w_rs_s_x", "bwx"}, {"b_w_rs_s_y", "bwy"}, {"b_w_rs_s_z", "bwz"});
    pose.accel_bias =
        vector(row, {"b_a_rs_s_x", "bax"}, {"b_a_rs_s_y", "bay"}, {"b_a_rs_s_z", "baz"});
    if (!truth.empty() && pose.timestamp_ns <= truth.back().timestamp_ns) {
      csv.fail(row, "the time does not increase");
    }
    truth.push_back(pose);
  }
  return truth;
}

}  // namespace

Dataset open_euroc(const std::string& folder) {
  fs::path mav = folder;
  if (fs::is_directory(mav / "mav0")) mav /= "mav0";
  Dataset dataset;
  dataset.kind = "EuRoC";
  std::optional<LocalMap> origin;
  read_drive_csv((mav / "imu0" / "data.csv").string(), dataset.log, origin);
  if (dataset.log.imu.empty()) {
    throw Error(fmt::format("{}: no inertial readings", (mav / "imu0" / "data.csv").string()));
  }
  dataset.log.noise = read_noise(mav / "imu0" / "sensor.yaml");
  dataset.log.truth = read_truth(mav / "state_groundtruth_estimate0");
  if (fs::is_directory(mav / "cam0") && fs::is_directory(mav / "cam1")) {
    dataset.frames = std::make_unique<EurocSource>(mav, dataset.log);
    if (dataset.frames->size() == 0) dataset.frames.reset();
  }
  return dataset;
}

}  // namespace partita::sensing
