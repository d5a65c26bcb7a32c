// The localization front-end of the paper (section "FPGA Based Localization System"): ORB features
// of a stereo pair, their association left to right and with the previous frame, and the camera's
// motion from these matches. Everything up to the lists of matches runs on the session's device, in
// integers, so that features, matches and the trajectory are the same on every device; the motion
// itself is a host step.
#ifndef PARTITA_HOST_TASKS_FRONTEND_FRONTEND_H
#define PARTITA_HOST_TASKS_FRONTEND_FRONTEND_H

#include <cstdint>
#include <memory>
#include <vector>

#include "host/runtime/session.h"
#include "host/tasks/frontend/counts.h"
#include "host/tasks/sensing/frame.h"

namespace partita::frontend {

using sensing::GrayImage;
using sensing::Pose;
using sensing::StereoCalibration;

/// All lengths are pixels of the original image unless said otherwise.
struct FrontendParameters {
  /// Features per image over both pyramid levels, 64..2048. The grid of cells is laid so that this
  /// is never exceeded; 59 % of them go to the full-size level.
  int max_features = 2000;
  /// FAST-9 threshold in grey levels, 1..254: how much brighter or darker an arc has to be.
  int fast_threshold = 20;
  /// Threshold for cells in which nothing exceeds fast_threshold, 1..fast_threshold.
  int fast_threshold_low = 7;
  /// Stereo search: half height of the row band, 0..16, and the largest disparity, 8..1024.
  int stereo_band = 2;
  int max_disparity = 192;
  /// Smallest refined disparity from which a point's depth is used, 0.25..16.
  double min_disparity = 1.5;
  /// Half size of the search window around the predicted position in the next frame, 4..256; the
  /// wide one (search_window..256) serves while no motion is known and when the small one gave too
  /// few inliers.
  int search_window = 24;
  int wide_search_window = 96;
  /// Largest Hamming distance of a match, of 256 bits, 0..256.
  int max_hamming = 64;
  /// A temporal match's distance must be at most this share of the second best's, in 1/256,
  /// 1..256.
  int ratio_q8 = 218;
  /// Largest sum of absolute differences over the 11 x 11 patch, 0..30855.
  int max_sad = 3000;
  /// Fewer inliers than this and the motion is not trusted, 6..1000.
  int min_inliers = 20;
  /// RANSAC: number of three-point hypotheses, 1..10000, and the inlier bound in pixels, 0.1..20.
  int ransac_hypotheses = 100;
  double inlier_bound = 1.5;
};

/// Throws Error that names the parameter, its value and its range.
void validate(const FrontendParameters& parameters);

/// A feature of the left image.
struct Feature {
  float x = 0;  ///< original image
  float y = 0;
  float disparity = 0;  ///< pixels; 0: no stereo match
  int level = 0;        ///< pyramid level, 0 or 1
  int previous = -1;    ///< index in the features of frame `reference`, -1: not matched
  bool inlier = false;  ///< its temporal match agrees with the motion
};

struct FrontendResult {
  std::int64_t frame = 0;
  Pose T_world_cam = Pose::Identity();  ///< left camera; the world is the first frame's camera
  std::int64_t reference = -1;          ///< frame that the matches lead to, -1: none
  bool first = false;                   ///< no previous frame: the pose is the origin's
  bool tracked = false;  ///< the pose comes from matches; if neither this nor `first`: too few, and
                         ///< the last motion was applied once more
  bool widened = false;  ///< the wide search window was used
  int keypoints_left = 0;
  int keypoints_right = 0;
  int stereo_matches = 0;
  int temporal_matches = 0;
  int inliers = 0;
  FrameCounts counts;             ///< what its cost followed from
  std::vector<Feature> features;  ///< all keypoints of the left image
};

class Frontend {
 public:
  /// Allocates everything that process() needs. The session must have been made with (at least) the
  /// kernels of kernel_specs() and must outlive this object. Throws Error for parameters out of
  /// range and for images below 64 x 64 or above 4096 x 4096.
  Frontend(const runtime::Session& session, const StereoCalibration& calibration,
           FrontendParameters parameters = {});
  ~Frontend();
  Frontend(const Frontend&) = delete;
  Frontend& operator=(const Frontend&) = delete;

  /// The next stereo pair. Frames count upwards; over a gap the motion goes on at the last velocity
  /// and the wide window is searched. A frame with too few features (a black image) is passed over:
  /// the next one is matched with the frame before. Throws Error if an image's size is not the
  /// calibration's or the frame is not later than the last one. The images are needed only during
  /// the call.
  FrontendResult process(const GrayImage& left, const GrayImage& right, std::int64_t frame);

  /// Forgets the previous frame, the motion and the pose.
  void reset();

  /// Launches every kernel at its exact geometry on a synthetic pair, then resets: the first real
  /// frame then pays for no compilation.
  void warm_up();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_FRONTEND_H
