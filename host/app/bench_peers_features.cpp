// The front-end's features beside OpenCV's ORB (Rublee et al., "ORB: An efficient alternative to
// SIFT or SURF", ICCV 2011) with the same settings, and the time that our association takes.
#include <algorithm>

#include <fmt/format.h>
#include <opencv2/core/version.hpp>
#include <opencv2/features2d.hpp>

#include "host/app/bench_peers.h"
#include "host/app/environment.h"
#include "host/app/wall_clock.h"
#include "host/runtime/session.h"
#include "host/tasks/frontend/associator.h"
#include "host/tasks/frontend/extractor.h"
#include "host/tasks/frontend/kernels.h"

namespace partita::app {
namespace {

using frontend::DeviceFeatures;

cv::Mat as_mat(const sensing::GrayImage& image) {
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data())};
}

/// Extracts one picture's features, down to keypoints and descriptors in host memory.
class Features {
 public:
  Features(const runtime::Session& session, frontend::Extractor& extractor)
      : session_(session), extractor_(extractor), features_(extractor.allocate()) {}

  void extract(const sensing::GrayImage& image) {
    extractor_.detect(image, features_);
    extractor_.read_count(features_);
    extractor_.describe(features_);
    const auto count = static_cast<std::size_t>(features_.features);
    keypoints_.resize(count);
    descriptors_.resize(count * 8);
    if (count == 0) return;
    session_.read(features_.keypoints, std::as_writable_bytes(std::span(keypoints_)));
    session_.read(features_.descriptors, std::as_writable_bytes(std::span(descriptors_)));
  }

  const DeviceFeatures& on_device() const { return features_; }

 private:
  const runtime::Session& session_;
  frontend::Extractor& extractor_;
  DeviceFeatures features_;
  std::vector<frontend::Keypoint> keypoints_;
  std::vector<std::uint32_t> descriptors_;
};

/// Median time of stereo association and of that with a later picture, which is the same one: as
/// many candidates as there can be.
double association_ms(frontend::Associator& associator, const Features& left, const Features& right,
                      int rounds) {
  const std::vector<frontend::Shift> shifts(static_cast<std::size_t>(left.on_device().features));
  const auto searched = static_cast<int>(shifts.size());
  std::vector<double> ms;
  for (int round = 0; round <= rounds; ++round) {
    const std::uint64_t start = wall_now();
    associator.stereo(left.on_device(), right.on_device());
    associator.temporal(left.on_device(), left.on_device(), shifts, searched, false);
    if (round > 0) ms.push_back(static_cast<double>(wall_now() - start) * 1e-6);
  }
  std::nth_element(ms.begin(), ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2), ms.end());
  return ms[ms.size() / 2];
}

}  // namespace

PeerComparison compare_features(const PeerOptions& options, const RoundDone& done) {
  const PeerPair input = peer_pair(options);
  set_emulation({.machine = kNativeMachine});
  const runtime::Device device = runtime::select_device(runtime::find_devices(), "cpu");
  const runtime::Session session(device, frontend::kernel_specs(),
                                 {.variant = runtime::Variant::cpu});
  const frontend::FrontendParameters parameters;
  frontend::Extractor extractor(session, {input.left.width, input.left.height}, parameters);
  frontend::Associator associator(session, extractor, parameters);
  Features left(session, extractor), right(session, extractor);

  cv::setNumThreads(static_cast<int>(options.cores));
  const auto orb = cv::ORB::create(parameters.max_features, 1.2F, frontend::kLevels, 31, 0, 2,
                                   cv::ORB::HARRIS_SCORE, 31, parameters.fast_threshold);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  const std::vector<std::function<void()>> contestants{
      [&] { left.extract(input.left); },
      [&] { orb->detectAndCompute(as_mat(input.left), cv::noArray(), keypoints, descriptors); }};
  const auto ms = time_in_turns(contestants, options.rounds, done);
  right.extract(input.right);
  const double association = association_ms(associator, left, right, options.rounds);

  const int features = left.on_device().features;
  const std::string settings =
      fmt::format("{} levels, at most {} features, FAST threshold {}", frontend::kLevels,
                  parameters.max_features, parameters.fast_threshold);
  PeerComparison comparison{
      .task = "features",
      .input = "left picture of " + input.name,
      .timed = "from a picture to keypoints and descriptors, both in host memory"};
  comparison.ours = {"partita front-end",
                     fmt::format("CPU variant on {}, {}", device.name, settings),
                     ms[0],
                     {{"features", features}, {"association_ms", association}},
                     fmt::format("{} features; associating them, left to right and with the next "
                                 "picture, {:.2f} ms",
                                 features, association)};
  comparison.peers = {{"cv::ORB",
                       fmt::format("OpenCV {}, scale 1.2, Harris score, {}", CV_VERSION, settings),
                       ms[1],
                       {{"features", keypoints.size()}},
                       fmt::format("{} features", keypoints.size())}};
  return comparison;
}

}  // namespace partita::app
