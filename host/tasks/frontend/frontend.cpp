#include "host/tasks/frontend/frontend.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/runtime/host_step.h"
#include "host/tasks/frontend/associator.h"
#include "host/tasks/frontend/cases.h"
#include "host/tasks/frontend/extractor.h"
#include "host/tasks/frontend/kernels.h"
#include "host/tasks/frontend/motion.h"
#include "host/tasks/frontend/shapes.h"

namespace partita::frontend {
namespace {

/// A prediction nearer than this says nothing: the feature is about to leave the image.
constexpr double kNearestPrediction = 0.5;

/// The frame that the next one is matched with.
struct Reference {
  std::int64_t frame = 0;
  Pose T_world_cam = Pose::Identity();
  DeviceFeatures features;
  std::vector<std::optional<Eigen::Vector3d>> points;  ///< per feature, camera axes
  std::vector<Keypoint> keypoints;
};

struct TrackResult {
  std::vector<RefinedMatch> matches;  ///< per feature of the reference
  std::vector<std::size_t> queries;   ///< features behind the observations
  MotionEstimate motion;
  SearchCounts counts;
};

Size checked_size(const StereoCalibration& calibration) {
  const auto fits = [](int length) { return length >= kMinSize && length <= kMaxSize; };
  if (!fits(calibration.width) || !fits(calibration.height)) {
    throw Error(fmt::format("frontend: images of {} x {}, expected {} to {} either way",
                            calibration.width, calibration.height, kMinSize, kMaxSize));
  }
  if (!(calibration.fx > 0) || !(calibration.fy > 0) || !(calibration.baseline > 0)) {
    throw Error(fmt::format("frontend: fx {}, fy {}, baseline {}, expected positive numbers",
                            calibration.fx, calibration.fy, calibration.baseline));
  }
  return {calibration.width, calibration.height};
}

FrontendParameters checked(const FrontendParameters& parameters) {
  validate(parameters);
  return parameters;
}

}  // namespace

class Frontend::Impl {
 public:
  Impl(const runtime::Session& session, const StereoCalibration& calibration,
       const FrontendParameters& parameters)
      : session_(session),
        calibration_(calibration),
        parameters_(checked(parameters)),
        extractor_(session, checked_size(calibration), parameters_),
        associator_(session, extractor_, parameters_),
        left_(extractor_.allocate()),
        right_(extractor_.allocate()) {
    reference_.features = extractor_.allocate();
  }

  FrontendResult process(const GrayImage& left, const GrayImage& right, std::int64_t frame) {
    session_.extension().set_label("frontend", frame);
    return step(left, right, frame);
  }
  void reset();
  void warm_up();

 private:
  FrontendResult step(const GrayImage& left, const GrayImage& right, std::int64_t frame);
  void check_image(const GrayImage& image, const char* which) const;
  void extract(const GrayImage& left, const GrayImage& right);
  void place_points(const std::vector<RefinedMatch>& stereo, Reference& current,
                    FrontendResult& result) const;
  std::vector<Shift> predict(const Pose& T_current_reference) const;
  TrackResult track(const Pose& predicted, bool wide);
  void localize(FrontendResult& result);
  void accept(const TrackResult& tracked, FrontendResult& result) const;

  const runtime::Session& session_;
  StereoCalibration calibration_;
  FrontendParameters parameters_;
  Extractor extractor_;
  Associator associator_;
  DeviceFeatures left_;
  DeviceFeatures right_;
  Reference reference_;
  bool has_reference_ = false;
  bool has_velocity_ = false;
  Pose velocity_ = Pose::Identity();  ///< T_next_current per frame
  std::int64_t last_frame_ = -1;
  Pose last_T_world_cam_ = Pose::Identity();
};

void Frontend::Impl::check_image(const GrayImage& image, const char* which) const {
  if (image.width == calibration_.width && image.height == calibration_.height &&
      image.pixels.size() == static_cast<std::size_t>(extractor_.size().pixels())) {
    return;
  }
  throw Error(fmt::format("frontend: {} image of {} x {}, expected {} x {} as calibrated", which,
                          image.width, image.height, calibration_.width, calibration_.height));
}

void Frontend::Impl::extract(const GrayImage& left, const GrayImage& right) {
  extractor_.detect(left, left_);
  extractor_.detect(right, right_);
  extractor_.read_count(left_);
  extractor_.read_count(right_);
  extractor_.describe(left_);
  extractor_.describe(right_);
}

void Frontend::Impl::place_points(const std::vector<RefinedMatch>& stereo, Reference& current,
                                  FrontendResult& result) const {
  const auto count = static_cast<std::size_t>(left_.features);
  current.keypoints.resize(count);
  current.points.assign(count, std::nullopt);
  result.features.resize(count);
  if (count == 0) return;
  session_.read(left_.keypoints, std::as_writable_bytes(std::span(current.keypoints)));
  for (std::size_t i = 0; i < count; ++i) {
    const Keypoint& keypoint = current.keypoints[i];
    const double x = keypoint.x_q8 / 256.0;
    const double y = keypoint.y_q8 / 256.0;
    Feature& feature = result.features[i];
    feature.x = static_cast<float>(x);
    feature.y = static_cast<float>(y);
    feature.level = keypoint.level();
    if (stereo[i].index < 0) continue;
    const double disparity = (keypoint.x_q8 - stereo[i].x_q8) / 256.0;
    if (disparity <= 0) continue;
    ++result.stereo_matches;
    feature.disparity = static_cast<float>(disparity);
    if (disparity < parameters_.min_disparity) continue;
    const double z = calibration_.fx * calibration_.baseline / disparity;
    current.points[i] = Eigen::Vector3d((x - calibration_.cx) * z / calibration_.fx,
                                        (y - calibration_.cy) * z / calibration_.fy, z);
  }
}

std::vector<Shift> Frontend::Impl::predict(const Pose& T_current_reference) const {
  std::vector<Shift> shifts(reference_.points.size(), Shift{kNoPrediction, 0});
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    if (!reference_.points[i]) continue;
    const Eigen::Vector3d p = T_current_reference * *reference_.points[i];
    if (p.z() < kNearestPrediction) continue;
    const double x = calibration_.fx * p.x() / p.z() + calibration_.cx;
    const double y = calibration_.fy * p.y() / p.z() + calibration_.cy;
    if (x < 0 || y < 0 || x > calibration_.width || y > calibration_.height) continue;
    const Keypoint& keypoint = reference_.keypoints[i];
    shifts[i] = {static_cast<std::int32_t>(std::lround(x * 256)) - keypoint.x_q8,
                 static_cast<std::int32_t>(std::lround(y * 256)) - keypoint.y_q8};
  }
  runtime::declare_host_step(session_, predict_spec(),
                             predict_shape(static_cast<int>(shifts.size())));
  return shifts;
}

TrackResult Frontend::Impl::track(const Pose& predicted, bool wide) {
  TrackResult result;
  const std::vector<Shift> shifts = predict(predicted);
  const auto searched = std::count_if(
      shifts.begin(), shifts.end(), [](const Shift& shift) { return shift.x_q8 != kNoPrediction; });
  result.counts = {.wide = wide, .searched = static_cast<int>(searched)};
  result.matches =
      associator_.temporal(reference_.features, left_, shifts, result.counts.searched, wide);
  std::vector<Observation> observations;
  for (std::size_t i = 0; i < result.matches.size(); ++i) {
    const RefinedMatch& match = result.matches[i];
    if (match.index < 0) continue;
    observations.push_back(
        {*reference_.points[i], Eigen::Vector2d(match.x_q8, match.y_q8) / 256.0});
    result.queries.push_back(i);
  }
  result.motion = estimate_motion(observations, calibration_, predicted, parameters_);
  result.counts.matches = static_cast<int>(observations.size());
  result.counts.hypotheses = result.motion.hypotheses;
  result.counts.inliers = result.motion.inlier_count;
  result.counts.iterations = result.motion.iterations;
  runtime::declare_host_step(session_, motion_spec(), motion_shape(result.counts));
  return result;
}

void Frontend::Impl::accept(const TrackResult& tracked, FrontendResult& result) const {
  result.temporal_matches = static_cast<int>(tracked.queries.size());
  result.inliers = tracked.motion.inlier_count;
  for (std::size_t k = 0; k < tracked.queries.size(); ++k) {
    const std::size_t i = tracked.queries[k];
    Feature& feature = result.features[static_cast<std::size_t>(tracked.matches[i].index)];
    feature.previous = static_cast<int>(i);
    feature.inlier = tracked.motion.inliers[k];
  }
}

void Frontend::Impl::localize(FrontendResult& result) {
  const auto gap = static_cast<double>(result.frame - reference_.frame);
  const Pose predicted = has_velocity_ ? scaled_motion(velocity_, gap) : Pose::Identity();
  result.reference = reference_.frame;
  result.widened = !has_velocity_ || gap > 1;
  TrackResult tracked = track(predicted, result.widened);
  result.counts.reference = static_cast<int>(reference_.points.size());
  result.counts.searches = {tracked.counts};
  if (tracked.motion.inlier_count < parameters_.min_inliers && !result.widened) {
    result.widened = true;
    tracked = track(predicted, true);
    result.counts.searches.push_back(tracked.counts);
  }
  accept(tracked, result);
  result.tracked = result.inliers >= parameters_.min_inliers;
  if (result.tracked) {
    velocity_ = scaled_motion(tracked.motion.T_current_reference, 1.0 / gap);
    has_velocity_ = true;
    result.T_world_cam = reference_.T_world_cam * tracked.motion.T_current_reference.inverse();
    return;
  }
  const auto since_last = static_cast<double>(result.frame - last_frame_);
  result.T_world_cam = last_T_world_cam_ * scaled_motion(velocity_, since_last).inverse();
}

FrontendResult Frontend::Impl::step(const GrayImage& left, const GrayImage& right,
                                    std::int64_t frame) {
  check_image(left, "left");
  check_image(right, "right");
  if (frame <= last_frame_) {
    throw Error(
        fmt::format("frontend: frame {} after frame {}, expected a later one", frame, last_frame_));
  }
  extract(left, right);

  FrontendResult result;
  result.frame = frame;
  result.keypoints_left = left_.features;
  result.keypoints_right = right_.features;
  result.counts.keypoints_left = left_.features;
  result.counts.keypoints_right = right_.features;
  Reference current;
  place_points(associator_.stereo(left_, right_), current, result);
  result.first = !has_reference_;
  if (has_reference_) localize(result);

  last_frame_ = frame;
  last_T_world_cam_ = result.T_world_cam;
  const auto usable = std::count_if(current.points.begin(), current.points.end(),
                                    [](const auto& point) { return point.has_value(); });
  if (!has_reference_ || usable >= parameters_.min_inliers) {
    std::swap(reference_.features, left_);
    reference_.points = std::move(current.points);
    reference_.keypoints = std::move(current.keypoints);
    reference_.frame = frame;
    reference_.T_world_cam = result.T_world_cam;
    has_reference_ = true;
  }
  return result;
}

void Frontend::Impl::reset() {
  has_reference_ = false;
  has_velocity_ = false;
  velocity_ = Pose::Identity();
  last_frame_ = -1;
  last_T_world_cam_ = Pose::Identity();
}

void Frontend::Impl::warm_up() {
  const Size size = extractor_.size();
  const GrayImage left = textured_image(size, 1);
  const GrayImage right = moved_image(left, -8, 0);
  session_.extension().set_label("frontend warm-up", -1);
  reset();
  step(left, right, 0);
  step(moved_image(left, 1, 1), moved_image(right, 1, 1), 1);
  session_.finish();
  reset();
}

Frontend::Frontend(const runtime::Session& session, const StereoCalibration& calibration,
                   FrontendParameters parameters)
    : impl_(std::make_unique<Impl>(session, calibration, parameters)) {}
Frontend::~Frontend() = default;

FrontendResult Frontend::process(const GrayImage& left, const GrayImage& right,
                                 std::int64_t frame) {
  return impl_->process(left, right, frame);
}

void Frontend::reset() {
  impl_->reset();
}
void Frontend::warm_up() {
  impl_->warm_up();
}

}  // namespace partita::frontend
