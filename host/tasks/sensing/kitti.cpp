// KITTI odometry sequences. What is accepted:
//   images      image_0 + image_1, image_l + image_r, or image_2 + image_3; .png .jpg .jpeg .pgm
//               .ppm, in capitals too; the same names on both sides, in the order of their names;
//               numbers (of up to ten digits, longer ones are time stamps) without a hole
//   calib.txt   see kitti_calibration.h
//   times.txt   seconds, one per frame; without it 10 Hz. times_right.txt, where the cameras have
//               clocks of their own, must agree with it (see synchronise.h)
//   poses.txt   or ../../poses/NN.txt, NN being the folder's name: the true trajectory, optional
//   imu.csv, gps.csv   see sensor_files.h, optional
//   disparity/  true disparities, 16-bit PNG, optional
#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "host/io/image.h"
#include "host/io/output_folder.h"
#include "host/io/text.h"
#include "host/io/trajectory.h"
#include "host/runtime/error.h"
#include "host/tasks/sensing/frame.h"
#include "host/tasks/sensing/kitti_calibration.h"
#include "host/tasks/sensing/sensor_files.h"
#include "host/tasks/sensing/synchronise.h"

namespace partita::sensing {

namespace fs = std::filesystem;

namespace {

struct Layout {
  const char* left;
  const char* right;
  int camera;  ///< index of the left camera's matrix in calib.txt
};
constexpr Layout kLayouts[] = {
    {"image_0", "image_1", 0}, {"image_l", "image_r", 0}, {"image_2", "image_3", 2}};

std::vector<std::string> picture_names(const fs::path& folder) {
  static const std::set<std::string> kExtensions = {".png", ".jpg", ".jpeg", ".pgm", ".ppm"};
  std::error_code error;
  std::vector<std::string> names;
  for (auto it = fs::directory_iterator(folder, error); !error && it != fs::directory_iterator();
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    std::string extension = it->path().extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (kExtensions.contains(extension) && name[0] != '.') names.push_back(name);
  }
  if (error) throw Error(fmt::format("cannot read '{}': {}", folder.string(), error.message()));
  std::sort(names.begin(), names.end());
  return names;
}

const Layout& find_layout(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw Error(fmt::format("data set '{}': no such folder", folder.string()));
  }
  if (io::is_partial(folder.string())) {
    throw Error(
        fmt::format("data set '{}': incomplete, its writing was interrupted (it holds the "
                    "mark PARTIAL)",
                    folder.string()));
  }
  for (const Layout& layout : kLayouts) {
    if (!fs::is_directory(folder / layout.left)) continue;
    if (fs::is_directory(folder / layout.right)) return layout;
    throw Error(fmt::format("data set '{}': '{}' without '{}', expected the right images there",
                            folder.string(), layout.left, layout.right));
  }
  throw Error(
      fmt::format("data set '{}': no images, expected image_0 and image_1, image_l and "
                  "image_r, or image_2 and image_3",
                  folder.string()));
}

/// Both folders must hold the same names; the message says how many each has and what is missing.
void check_pairs(const fs::path& folder, const Layout& layout, const std::vector<std::string>& left,
                 const std::vector<std::string>& right) {
  if (left.empty() && right.empty()) {
    throw Error(fmt::format("data set '{}': no images in '{}'", folder.string(), layout.left));
  }
  const auto missing_in = [&](const char* where, const auto& from, const auto& in) {
    for (const std::string& name : from) {
      if (std::binary_search(in.begin(), in.end(), name)) continue;
      throw Error(fmt::format("data set '{}': {} left and {} right images, '{}/{}' is missing",
                              folder.string(), left.size(), right.size(), where, name));
    }
  };
  missing_in(layout.right, left, right);
  missing_in(layout.left, right, left);
}

/// The number that a picture is named by, if it is: 000042.png. A longer one is a time stamp.
std::optional<std::uint64_t> picture_number(const std::string& name) {
  constexpr std::size_t kMostDigits = 10;
  const std::string stem = fs::path(name).stem().string();
  if (stem.size() > kMostDigits || stem.find_first_not_of("0123456789") != std::string::npos) {
    return std::nullopt;
  }
  return std::stoull(stem);
}

/// Puts pictures that are named by numbers in the numbers' order (2 before 10). Times and poses
/// belong to the pictures by their order, so that a hole in the numbering would pair all behind it
/// with the wrong ones: refused. The first number may be any; names that are not all numbers stay.
void order_by_number(const fs::path& folder, std::vector<std::string>& names) {
  const auto unnumbered = [](const std::string& name) { return !picture_number(name); };
  if (std::any_of(names.begin(), names.end(), unnumbered)) return;
  std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
    return *picture_number(a) < *picture_number(b);
  });
  for (std::size_t i = 1; i < names.size(); ++i) {
    const std::uint64_t expected = *picture_number(names[i - 1]) + 1;
    if (*picture_number(names[i]) == expected) continue;
    const fs::path previous(names[i - 1]);
    throw Error(
        fmt::format("{}/{:0{}}{} is missing: '{}' follows '{}', expected images numbered "
                    "without a hole",
                    folder.string(), expected, previous.stem().string().size(),
                    previous.extension().string(), names[i], names[i - 1]));
  }
}

std::vector<std::int64_t> read_times(const fs::path& path, std::size_t frames) {
  const io::TextFile file(path.string());
  std::vector<std::int64_t> times;
  for (const io::TextRow& row : file.rows()) {
    const double seconds = file.numbers(row, 0, 1, "the time of a frame in seconds")[0];
    if (!(seconds >= 0 && seconds <= 9e9)) file.fail(row, "the time is out of range");
    times.push_back(std::llround(seconds * 1e9));
    if (times.size() > 1 && times.back() <= times[times.size() - 2]) {
      file.fail(row, "the time does not increase");
    }
  }
  if (times.size() < frames) {
    throw Error(fmt::format("{}: {} times, expected one for each of the {} frames", path.string(),
                            times.size(), frames));
  }
  times.resize(frames);
  return times;
}

class KittiSource final : public FrameSource {
 public:
  explicit KittiSource(const std::string& folder);

  std::string name() const override { return folder_.string(); }
  const StereoCalibration& calibration() const override { return calibration_; }
  std::size_t size() const override { return names_.size(); }
  std::int64_t timestamp_ns(std::size_t index) const override { return times_.at(index); }
  Frame frame(std::size_t index) const override;
  std::optional<std::vector<Pose>> true_poses() const override { return poses_; }
  std::vector<std::string> notices() const override;

 private:
  void read_all_times();
  void read_poses();
  void read_size();
  GrayImage read_picture(const fs::path& path) const;
  void notice(const std::string& text) const;

  fs::path folder_;
  Layout layout_{};
  std::vector<std::string> names_;
  std::vector<std::int64_t> times_;
  std::optional<std::vector<Pose>> poses_;
  std::vector<ImuSample> imu_;
  std::vector<GpsFix> gps_;
  StereoCalibration calibration_;
  mutable std::mutex notices_mutex_;
  mutable std::vector<std::string> notices_;
};

KittiSource::KittiSource(const std::string& folder)
    : folder_(folder),
      layout_(find_layout(folder_)),
      names_(picture_names(folder_ / layout_.left)) {
  check_pairs(folder_, layout_, names_, picture_names(folder_ / layout_.right));
  order_by_number(folder_ / layout_.left, names_);
  calibration_ = read_kitti_calibration((folder_ / "calib.txt").string(), layout_.camera);
  read_all_times();
  read_poses();
  if (fs::exists(folder_ / "imu.csv")) imu_ = read_imu((folder_ / "imu.csv").string());
  if (fs::exists(folder_ / "gps.csv")) gps_ = read_gps((folder_ / "gps.csv").string());
  read_size();
}

void KittiSource::read_all_times() {
  if (!fs::exists(folder_ / "times.txt")) {
    constexpr std::int64_t kPeriod = 100'000'000;
    for (std::size_t i = 0; i < size(); ++i)
      times_.push_back(kPeriod * static_cast<std::int64_t>(i));
    notice(fmt::format("{}: no times.txt, 10 Hz assumed", folder_.string()));
    return;
  }
  times_ = read_times(folder_ / "times.txt", size());
  if (!fs::exists(folder_ / "times_right.txt")) return;
  const auto right = read_times(folder_ / "times_right.txt", size());
  for (std::size_t i = 0; i < size(); ++i) {
    check_synchronised((folder_ / names_[i]).string(), times_[i], right[i]);
  }
}

void KittiSource::read_poses() {
  fs::path path = folder_ / "poses.txt";
  if (!fs::exists(path)) {
    const fs::path whole = fs::absolute(folder_).lexically_normal();
    const fs::path sequence = whole.has_filename() ? whole : whole.parent_path();
    path = sequence.parent_path().parent_path() / "poses" / (sequence.filename().string() + ".txt");
  }
  if (!fs::exists(path)) return;
  poses_ = io::read_kitti_trajectory(path.string());
  if (poses_->size() < size()) {
    throw Error(fmt::format("{}: {} poses, expected one for each of the {} frames", path.string(),
                            poses_->size(), size()));
  }
  if (poses_->size() > size()) {
    notice(fmt::format("{}: {} poses for {} frames, the rest is not used", path.string(),
                       poses_->size(), size()));
    poses_->resize(size());
  }
}

/// The calibration file does not say how large the pictures are; the first one does.
void KittiSource::read_size() {
  const fs::path path = folder_ / layout_.left / names_[0];
  const GrayImage first = io::read_gray(path.string()).image;
  calibration_.width = first.width;
  calibration_.height = first.height;
  const StereoCalibration& c = calibration_;
  if (!(c.cx > 0 && c.cx < c.width && c.cy > 0 && c.cy < c.height)) {
    throw Error(
        fmt::format("{}: picture is {}x{}, but calib.txt puts the optical axis at ({:g}, {:g})",
                    path.string(), c.width, c.height, c.cx, c.cy));
  }
}

GrayImage KittiSource::read_picture(const fs::path& path) const {
  io::GrayRead read = io::read_gray(path.string());
  if (read.image.width != calibration_.width || read.image.height != calibration_.height) {
    throw Error(fmt::format("{}: picture is {}x{}, expected {}x{} as the sequence's first",
                            path.string(), read.image.width, read.image.height, calibration_.width,
                            calibration_.height));
  }
  if (!read.converted.empty()) {
    notice(fmt::format("{}: {} pictures, converted to 8-bit gray", path.parent_path().string(),
                       read.converted));
  }
  return std::move(read.image);
}

void KittiSource::notice(const std::string& text) const {
  const std::scoped_lock lock(notices_mutex_);
  if (std::find(notices_.begin(), notices_.end(), text) == notices_.end()) notices_.push_back(text);
}

std::vector<std::string> KittiSource::notices() const {
  const std::scoped_lock lock(notices_mutex_);
  return notices_;
}

Frame KittiSource::frame(std::size_t index) const {
  const std::string& name = names_.at(index);
  Frame f;
  f.index = index;
  f.timestamp_ns = times_[index];
  f.left = read_picture(folder_ / layout_.left / name);
  f.right = read_picture(folder_ / layout_.right / name);
  const std::int64_t before = index > 0 ? times_[index - 1] : f.timestamp_ns - 1;
  f.imu = readings_between(imu_, before, f.timestamp_ns);
  f.gps = readings_between(gps_, before, f.timestamp_ns);
  if (poses_) f.T_world_cam = (*poses_)[index];
  const fs::path truth = folder_ / "disparity" / fs::path(name).replace_extension(".png");
  if (fs::exists(truth)) {
    f.disparity = io::read_disparity(truth.string());
    if (f.disparity->width != f.left.width || f.disparity->height != f.left.height) {
      throw Error(fmt::format("{}: {}x{}, expected {}x{} as the pictures", truth.string(),
                              f.disparity->width, f.disparity->height, f.left.width,
                              f.left.height));
    }
  }
  return f;
}

}  // namespace

std::unique_ptr<FrameSource> open_kitti(const std::string& folder) {
  return std::make_unique<KittiSource>(folder);
}

}  // namespace partita::sensing
