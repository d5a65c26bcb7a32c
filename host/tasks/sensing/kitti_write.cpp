#include "host/tasks/sensing/kitti_write.h"

#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "host/io/file.h"
#include "host/io/image.h"
#include "host/io/output_folder.h"
#include "host/io/trajectory.h"
#include "host/tasks/sensing/kitti_calibration.h"
#include "host/tasks/sensing/sensor_files.h"

namespace partita::sensing {

namespace {

// What an annotator would leave out: too small or too well hidden to tell what it is.
constexpr double kLeastLabelledHeight = 20;  // pixels
constexpr double kLeastLabelledShare = 0.25;

/// type truncated occluded alpha left top right bottom height width length x y z rotation_y
std::string label(const ObjectBox& b) {
  if (b.height < kLeastLabelledHeight || b.visible < kLeastLabelledShare) {
    return fmt::format(
        "DontCare -1 -1 -10 {:.2f} {:.2f} {:.2f} {:.2f} -1 -1 -1 -1000 -1000 -1000 "
        "-10\n",
        b.x, b.y, b.x + b.width, b.y + b.height);
  }
  const int occluded = b.visible > 0.8 ? 0 : b.visible > 0.4 ? 1 : 2;
  return fmt::format(
      "{} {:.2f} {} -10 {:.2f} {:.2f} {:.2f} {:.2f} -1 -1 -1 -1000 -1000 {:.2f} -10\n",
      to_string(b.object_class), b.truncated, occluded, b.x, b.y, b.x + b.width, b.y + b.height,
      b.distance);
}

std::string seconds(std::int64_t ns) {
  return fmt::format("{}.{:09}\n", ns / 1'000'000'000, ns % 1'000'000'000);
}

/// What one frame adds to the folder: its pictures at once, its readings to the lists.
class Writer {
 public:
  explicit Writer(const std::string& folder)
      : out_(folder, io::kGenerateWriter),
        left_(out_.series("image_0", ".png")),
        right_(out_.series("image_1", ".png")),
        disparity_(out_.series("disparity", ".png")),
        label_(out_.series("label_2", ".txt")) {}

  void add(const Frame& f) {
    const std::string name = fmt::format("/{:06}", f.index);
    io::write_gray(left_ + name + ".png", f.left);
    io::write_gray(right_ + name + ".png", f.right);
    if (f.disparity) io::write_disparity(disparity_ + name + ".png", *f.disparity);
    if (f.boxes) {
      std::string text;
      for (const ObjectBox& b : *f.boxes) text += label(b);
      io::write_file(label_ + name + ".txt", text);
    }
    times_ += seconds(f.timestamp_ns);
    imu_.insert(imu_.end(), f.imu.begin(), f.imu.end());
    gps_.insert(gps_.end(), f.gps.begin(), f.gps.end());
  }

  void finish(const FrameSource& source) {
    write_kitti_calibration(out_.file("calib.txt"), source.calibration());
    io::write_file(out_.file("times.txt"), times_);
    if (const auto poses = source.true_poses()) {
      io::write_kitti_trajectory(out_.file("poses.txt"), *poses);
    }
    if (!imu_.empty()) write_imu(out_.file("imu.csv"), imu_);
    if (!gps_.empty()) write_gps(out_.file("gps.csv"), gps_);
    out_.complete();
  }

 private:
  io::OutputFolder out_;
  std::string left_;
  std::string right_;
  std::string disparity_;
  std::string label_;
  std::string times_;
  std::vector<ImuSample> imu_;
  std::vector<GpsFix> gps_;
};

}  // namespace

void write_kitti(const FrameSource& source, const std::string& folder,
                 const std::function<void(std::size_t, std::size_t)>& progress) {
  Writer writer(folder);
  for (std::size_t i = 0; i < source.size(); ++i) {
    writer.add(source.frame(i));
    if (progress) progress(i + 1, source.size());
  }
  writer.finish(source);
}

}  // namespace partita::sensing
