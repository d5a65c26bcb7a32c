// What the sensors deliver, and where frames come from: a data set on disk or the built-in
// scenario. No OpenCV here, so that the tasks behind sensing can be built and tested without it.
#ifndef PARTITA_HOST_TASKS_SENSING_FRAME_H
#define PARTITA_HOST_TASKS_SENSING_FRAME_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace partita::sensing {

/// A picture of one channel, row-major without padding. pixels.size() == width * height.
template <class T>
struct Image {
  int width = 0;
  int height = 0;
  std::vector<T> pixels;

  Image() = default;
  Image(int w, int h, T value = T{})
      : width(w),
        height(h),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}

  bool empty() const { return pixels.empty(); }
  T* row(int y) { return pixels.data() + static_cast<std::size_t>(y) * width; }
  const T* row(int y) const { return pixels.data() + static_cast<std::size_t>(y) * width; }
  T& at(int x, int y) { return row(y)[x]; }
  T at(int x, int y) const { return row(y)[x]; }
  bool operator==(const Image&) const = default;
};

using GrayImage = Image<std::uint8_t>;
using FloatImage = Image<float>;

struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb&) const = default;
};
using ColourImage = Image<Rgb>;

/// A rectified stereo pair: both cameras share intrinsics and orientation, the right one sits
/// `baseline` metres along +x of the left. Camera axes as in KITTI: x right, y down, z forward.
/// Pixel (x, y) names the pixel's centre. disparity = fx * baseline / depth, in pixels.
struct StereoCalibration {
  double fx = 0;
  double fy = 0;
  double cx = 0;
  double cy = 0;
  double baseline = 0;  ///< metres, positive
  int width = 0;
  int height = 0;
};

/// T_world_cam: takes a point from the left camera's axes to the world's (the first camera's axes,
/// unless the source says otherwise). Metres.
using Pose = Eigen::Isometry3d;

/// One reading of the inertial unit, which is mounted at the left camera with the camera's axes.
struct ImuSample {
  std::int64_t timestamp_ns = 0;
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< m/s^2, specific force: at rest it is -g
};

/// One position fix: metres east, north, up of the source's origin.
struct GpsFix {
  std::int64_t timestamp_ns = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double sigma = 0;  ///< standard deviation of each horizontal coordinate, metres
  std::optional<double> speed = {};   ///< over ground, m/s
  std::optional<double> course = {};  ///< where it moves to, rad clockwise from north
  std::size_t line = 0;               ///< of the file that it is from, 0: none
};

enum class ObjectClass : std::uint8_t { car, pedestrian, cyclist };
const char* to_string(ObjectClass c);  ///< KITTI's names: "Car", "Pedestrian", "Cyclist"

/// The extent of what the left image shows of one road user, in pixels: [x, x+width) x
/// [y, y+height). What others hide does not count.
struct ObjectBox {
  ObjectClass object_class = ObjectClass::car;
  int id = 0;  ///< the same object keeps its id over all frames
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
  double distance = 0;   ///< depth of the object's centre, metres
  double visible = 1;    ///< share of the object's projection that nothing hides, 0..1
  double truncated = 0;  ///< share of its extent that lies outside of the image, 0..1
};

/// One moment of the vehicle's cameras, with all other readings since the frame before.
struct Frame {
  std::size_t index = 0;
  std::int64_t timestamp_ns = 0;
  GrayImage left;
  GrayImage right;
  std::vector<ImuSample> imu;  ///< previous frame's time < t <= this frame's time
  std::vector<GpsFix> gps;     ///< likewise

  // Truth, where the source knows it.
  std::optional<Pose> T_world_cam;
  std::optional<FloatImage> depth;      ///< metres along z, 0 where there is none (sky)
  std::optional<FloatImage> disparity;  ///< pixels, of the left image, 0 where there is none
  std::optional<std::vector<ObjectBox>> boxes;
};

/// Where frames come from. Frames can be asked for in any order and as often as one likes, each
/// time with the same result; each call reads or renders anew. frame() may be called from several
/// threads at once. Throws partita::Error for data that are missing or broken.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  virtual std::string name() const = 0;
  virtual const StereoCalibration& calibration() const = 0;
  virtual std::size_t size() const = 0;
  virtual std::int64_t timestamp_ns(std::size_t index) const = 0;  ///< strictly increasing
  virtual Frame frame(std::size_t index) const = 0;                ///< index < size()

  /// The true trajectory, one pose per frame, where the source knows it.
  virtual std::optional<std::vector<Pose>> true_poses() const { return std::nullopt; }

  /// What was odd about the data yet acceptable (colour images that were converted, say): one line
  /// each, for the user's information. May grow while frames are read.
  virtual std::vector<std::string> notices() const { return {}; }
};

/// Opens a sequence folder in the layout of KITTI odometry; see kitti.cpp for what it accepts.
/// Reads calibration, times and poses and lists the images; pictures are read by frame().
std::unique_ptr<FrameSource> open_kitti(const std::string& folder);

struct ScenarioOptions {
  std::uint64_t seed = 1;
  std::size_t frames = 30;
  int width = 1280;
  int height = 720;
  double rate_hz = 10;
};

/// The built-in street. The same options give the same bytes on every machine.
std::unique_ptr<FrameSource> open_scenario(const ScenarioOptions& options);

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_FRAME_H
