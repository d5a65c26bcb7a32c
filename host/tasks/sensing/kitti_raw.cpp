// KITTI raw recordings (Geiger et al., "Vision meets robotics: the KITTI dataset", IJRR 2013):
//   image_00, image_01   timestamps.txt, data/NNNNNNNNNN.png; gray stereo, rectified ("sync") or
//   not
//                        ("extract"): the pictures' size tells, and those that are not are
//                        rectified
//   calib_cam_to_cam.txt, calib_imu_to_velo.txt, calib_velo_to_cam.txt   here, in a folder here, or
//                        one above; the last two only where OXTS is used
//   oxts/ or oxts_sparse.csv   see oxts.h, optional
#include <algorithm>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "host/io/image.h"
#include "host/io/text.h"
#include "host/runtime/error.h"
#include "host/tasks/sensing/dataset.h"
#include "host/tasks/sensing/oxts.h"
#include "host/tasks/sensing/rectify.h"
#include "host/tasks/sensing/synchronise.h"

namespace partita::sensing {
namespace {

namespace fs = std::filesystem;

/// "KEY: numbers …" lines.
class CalibrationFile {
 public:
  explicit CalibrationFile(const std::string& path) : file_(path) {}
  std::vector<double> get(const std::string& key, std::size_t count) const {
    for (const io::TextRow& row : file_.rows()) {
      if (row.words[0] == key + ":") {
        return file_.numbers(row, 1, count, fmt::format("the {} of {}", count, key));
      }
    }
    throw Error(fmt::format("{}: no line '{}:'", file_.path(), key));
  }
  Eigen::Matrix3d matrix(const std::string& key) const {
    const std::vector<double> v = get(key, 9);
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data());
  }
  Eigen::Matrix3d rotation(const std::string& key) const {
    const Eigen::Matrix3d R = matrix(key);
    if (!((R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-3) ||
        R.determinant() < 0) {
      throw Error(fmt::format("{}: {} is not a rotation", file_.path(), key));
    }
    return Eigen::Quaterniond(R).normalized().toRotationMatrix();
  }
  Pose rigid() const {
    Pose pose = Pose::Identity();
    pose.linear() = rotation("R");
    const std::vector<double> t = get("T", 3);
    pose.translation() = Eigen::Vector3d(t[0], t[1], t[2]);
    return pose;
  }
  const std::string& path() const { return file_.path(); }

 private:
  io::TextFile file_;
};

std::optional<fs::path> find_calibration(const fs::path& folder) {
  const char* const kName = "calib_cam_to_cam.txt";
  if (fs::exists(folder / kName)) return folder;
  std::error_code code;
  std::vector<fs::path> found;
  for (auto it = fs::directory_iterator(folder, code); !code && it != fs::directory_iterator();
       it.increment(code)) {
    if (fs::exists(it->path() / kName)) found.push_back(it->path());
  }
  std::sort(found.begin(), found.end());
  if (!found.empty()) return found.front();
  const fs::path above = fs::absolute(folder).lexically_normal() / "..";
  if (fs::exists(above / kName)) return above;
  return std::nullopt;
}

RawCamera raw_camera(const CalibrationFile& file, const std::string& camera) {
  const Eigen::Matrix3d K = file.matrix("K_" + camera);
  const std::vector<double> D = file.get("D_" + camera, 5), S = file.get("S_" + camera, 2);
  RawCamera raw;
  raw.fx = K(0, 0);
  raw.fy = K(1, 1);
  raw.cx = K(0, 2);
  raw.cy = K(1, 2);
  std::copy(D.begin(), D.end(), raw.distortion.begin());
  if (!(raw.fx > 1 && raw.fy > 1 && S[0] >= 16 && S[1] >= 16 && S[0] <= 8192 && S[1] <= 8192)) {
    throw Error(fmt::format("{}: K_{} and S_{} are no camera's", file.path(), camera, camera));
  }
  raw.width = static_cast<int>(S[0]);
  raw.height = static_cast<int>(S[1]);
  return raw;
}

StereoCalibration rectified(const CalibrationFile& file) {
  const std::vector<double> left = file.get("P_rect_00", 12), right = file.get("P_rect_01", 12),
                            size = file.get("S_rect_00", 2);
  StereoCalibration c;
  c.fx = left[0];
  c.fy = left[5];
  c.cx = left[2];
  c.cy = left[6];
  c.baseline = (left[3] - right[3]) / left[0];
  if (!(c.fx > 1 && c.fy > 1 && c.baseline > 1e-3 && size[0] >= 16 && size[1] >= 16 &&
        size[0] <= 8192 && size[1] <= 8192)) {
    throw Error(
        fmt::format("{}: P_rect_00, P_rect_01 and S_rect_00 are no stereo pair's", file.path()));
  }
  c.width = static_cast<int>(size[0]);
  c.height = static_cast<int>(size[1]);
  return c;
}

class KittiRawSource final : public FrameSource {
 public:
  KittiRawSource(const fs::path& folder, const CalibrationFile& calibration)
      : folder_(folder), calibration_(rectified(calibration)) {
    find_pairs();
    const GrayImage first = io::read_gray(picture(0, pairs_[0].number).string()).image;
    if (first.width == calibration_.width && first.height == calibration_.height) return;
    const RawCamera left = raw_camera(calibration, "00"), right = raw_camera(calibration, "01");
    if (first.width != left.width || first.height != left.height) {
      throw Error(fmt::format("{}: picture is {}x{}, expected {}x{} or, rectified, {}x{}",
                              picture(0, pairs_[0].number).string(), first.width, first.height,
                              left.width, left.height, calibration_.width, calibration_.height));
    }
    maps_[0] = std::make_unique<RectifyMap>(left, calibration.rotation("R_rect_00"), calibration_);
    maps_[1] = std::make_unique<RectifyMap>(right, calibration.rotation("R_rect_01"), calibration_);
    notices_.push_back(fmt::format("{}: pictures of {}x{} are rectified to {}x{} as they are read",
                                   folder.string(), left.width, left.height, calibration_.width,
                                   calibration_.height));
  }

  std::string name() const override { return folder_.string(); }
  const StereoCalibration& calibration() const override { return calibration_; }
  std::size_t size() const override { return pairs_.size(); }
  std::int64_t timestamp_ns(std::size_t i) const override { return pairs_.at(i).timestamp_ns; }
  std::vector<std::string> notices() const override { return notices_; }
  std::int64_t start_ns() const { return start_ns_; }
  Frame frame(std::size_t index) const override {
    Frame f;
    f.index = index;
    f.timestamp_ns = pairs_.at(index).timestamp_ns;
    f.left = read(0, pairs_[index].number);
    f.right = read(1, pairs_[index].number);
    return f;
  }

 private:
  struct Pair {
    std::size_t number = 0;
    std::int64_t timestamp_ns = 0;
  };

  fs::path picture(int side, std::size_t number) const {
    return folder_ / (side == 0 ? "image_00" : "image_01") / "data" /
           fmt::format("{:010}.png", number);
  }

  /// Pictures that only one camera has, and those taken at different moments, are left out.
  void find_pairs() {
    const auto left = read_kitti_timestamps((folder_ / "image_00" / "timestamps.txt").string());
    const auto right = read_kitti_timestamps((folder_ / "image_01" / "timestamps.txt").string());
    if (left.empty()) throw Error(fmt::format("{}: no times of pictures", folder_.string()));
    start_ns_ = left.front();
    // Both cameras have one trigger; the stamps are the computer's, a millisecond or two apart.
    constexpr std::int64_t kStampNs = 5'000'000;
    std::size_t apart = 0, alone = 0;
    for (std::size_t k = 0; k < std::min(left.size(), right.size()); ++k) {
      const bool has_left = fs::exists(picture(0, k)), has_right = fs::exists(picture(1, k));
      if (has_left != has_right) ++alone;
      if (!has_left || !has_right) continue;
      if (std::abs(left[k] - right[k]) > kStampNs) {
        ++apart;
        continue;
      }
      pairs_.push_back({k, left[k]});
    }
    if (alone > 0)
      notices_.push_back(fmt::format("{}: {} pictures have no partner", folder_.string(), alone));
    if (apart > 0) {
      notices_.push_back(
          fmt::format("{}: {} pairs are out of sync and left out", folder_.string(), apart));
    }
    if (pairs_.empty()) {
      throw Error(
          fmt::format("{}: no stereo pair, expected image_00/data/0000000000.png and "
                      "image_01/data/0000000000.png …",
                      folder_.string()));
    }
  }

  GrayImage read(int side, std::size_t number) const {
    const std::string path = picture(side, number).string();
    GrayImage image = io::read_gray(path).image;
    const auto& map = maps_[static_cast<std::size_t>(side)];
    if (!map) {
      if (image.width == calibration_.width && image.height == calibration_.height) return image;
      throw Error(fmt::format("{}: picture is {}x{}, expected {}x{}", path, image.width,
                              image.height, calibration_.width, calibration_.height));
    }
    try {
      return map->apply(image);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", path, error.what()));
    }
  }

  fs::path folder_;
  StereoCalibration calibration_;
  std::vector<Pair> pairs_;
  std::int64_t start_ns_ = 0;
  std::unique_ptr<RectifyMap> maps_[2];
  std::vector<std::string> notices_;
};

}  // namespace

Dataset open_kitti_raw(const std::string& folder) {
  const std::optional<fs::path> calibration = find_calibration(folder);
  if (!calibration) {
    throw Error(
        fmt::format("data set '{}': no calib_cam_to_cam.txt here, in a folder here, or one "
                    "above",
                    folder));
  }
  const CalibrationFile cameras((*calibration / "calib_cam_to_cam.txt").string());
  auto source = std::make_unique<KittiRawSource>(folder, cameras);
  Dataset dataset;
  dataset.kind = "KITTI raw";
  read_oxts(folder, source->start_ns(), dataset.log);
  if (!dataset.log.imu.empty()) {
    const CalibrationFile imu((*calibration / "calib_imu_to_velo.txt").string());
    const CalibrationFile velodyne((*calibration / "calib_velo_to_cam.txt").string());
    Pose rectification = Pose::Identity();
    rectification.linear() = cameras.rotation("R_rect_00");
    dataset.log.T_imu_cam = (rectification * velodyne.rigid() * imu.rigid()).inverse();
    dataset.log.R_imu_vehicle = Eigen::Matrix3d::Identity();
  } else {
    dataset.log.R_imu_vehicle = vehicle_in_camera_axes();
  }
  dataset.frames = std::move(source);
  return dataset;
}

}  // namespace partita::sensing
