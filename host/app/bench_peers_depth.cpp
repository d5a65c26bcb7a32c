// Depth beside OpenCV's semi-global matching (Hirschmüller, "Stereo Processing by Semiglobal
// Matching and Mutual Information", PAMI 2008), the stereo matcher that most people use.
#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/version.hpp>

#include "host/app/bench_peers.h"
#include "host/app/depth_output.h"
#include "host/app/environment.h"
#include "host/runtime/session.h"
#include "host/tasks/depth/evaluation.h"
#include "host/tasks/depth/kernels.h"

namespace partita::app {
namespace {

constexpr int kDisparities = 128;
constexpr int kBlock = 5;

cv::Mat as_mat(const sensing::GrayImage& image) {
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data())};
}

/// SGBM's disparities are in sixteenths, and negative where there is none.
sensing::FloatImage to_pixels(const cv::Mat& sixteenths) {
  sensing::FloatImage image(sixteenths.cols, sixteenths.rows);
  for (int y = 0; y < image.height; ++y) {
    const auto* row = sixteenths.ptr<std::int16_t>(y);
    for (int x = 0; x < image.width; ++x) {
      image.at(x, y) = row[x] < 0 ? 0.0F : std::max(static_cast<float>(row[x]) / 16, 1.0F / 256);
    }
  }
  return image;
}

/// OpenCV's matcher with the penalties that its documentation proposes.
struct Sgbm {
  explicit Sgbm(int mode)
      : matcher(cv::StereoSGBM::create(0, kDisparities, kBlock, 8 * kBlock * kBlock,
                                       32 * kBlock * kBlock, 1, 63, 10, 100, 32, mode)) {}
  cv::Ptr<cv::StereoSGBM> matcher;
  cv::Mat map;
};

/// Adds how good the map is, if the truth is known.
Contestant judged(Contestant contestant, const sensing::FloatImage& map,
                  const std::optional<sensing::FloatImage>& truth) {
  if (!truth) return contestant;
  const depth::Evaluation e = depth::evaluate(map, *truth);
  contestant.quality = {{"density", e.density()},
                        {"bad1_percent", e.bad1_percent()},
                        {"bad3_percent", e.bad3_percent()},
                        {"mean_error_px", e.mean_error_px()}};
  contestant.quality_text = fmt::format("density {:.1f} %, bad-1 {:.2f} %, bad-3 {:.2f} %",
                                        100 * e.density(), e.bad1_percent(), e.bad3_percent());
  return contestant;
}

}  // namespace

PeerComparison compare_depth(const PeerOptions& options, const RoundDone& done) {
  const PeerPair input = peer_pair(options);
  const sensing::GrayImage& left = input.left;
  const sensing::GrayImage& right = input.right;
  set_emulation({.machine = kNativeMachine});
  const runtime::Device device = runtime::select_device(runtime::find_devices(), "cpu");
  const runtime::Session session(device, depth::kernel_specs(), {.variant = runtime::Variant::cpu});
  const depth::DepthParameters parameters = depth::default_parameters(left.width);
  depth::Depth depth(session, left.width, left.height, parameters);
  depth::DisparityMap map;

  cv::setNumThreads(static_cast<int>(options.cores));
  Sgbm five_ways(cv::StereoSGBM::MODE_SGBM);
  Sgbm three_ways(cv::StereoSGBM::MODE_SGBM_3WAY);
  const auto match = [&](Sgbm& sgbm) {
    sgbm.matcher->compute(as_mat(left), as_mat(right), sgbm.map);
  };
  const std::vector<std::function<void()>> contestants{[&] { map = depth.process(left, right, 0); },
                                                       [&] { match(five_ways); },
                                                       [&] { match(three_ways); }};
  const auto ms = time_in_turns(contestants, options.rounds, done);

  const std::string sgbm_parameters = fmt::format(
      "OpenCV {}, {} disparities, {} x {}, P1 {}, P2 {}, disp12MaxDiff 1, preFilterCap 63, "
      "uniquenessRatio 10, speckles of 100 at 32",
      CV_VERSION, kDisparities, kBlock, kBlock, 8 * kBlock * kBlock, 32 * kBlock * kBlock);
  PeerComparison comparison{.task = "depth",
                            .input = input.name,
                            .timed = "from pictures to disparity map, both in host memory"};
  comparison.ours = judged({"partita depth",
                            fmt::format("CPU variant on {}, setting robotics, {} disparities",
                                        device.name, parameters.max_disparity + 1),
                            ms[0]},
                           to_pixels(map), input.truth);
  comparison.peers = {judged({"cv::StereoSGBM", "MODE_SGBM, " + sgbm_parameters, ms[1]},
                             to_pixels(five_ways.map), input.truth),
                      judged({"cv::StereoSGBM, 3 ways", "MODE_SGBM_3WAY, else the same", ms[2]},
                             to_pixels(three_ways.map), input.truth)};
  return comparison;
}

}  // namespace partita::app
