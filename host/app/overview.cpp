// overview.png: one picture that says what the run saw and computed.
#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "host/app/run.h"
#include "host/io/file.h"

namespace partita::app {
namespace {

const cv::Scalar kWhite(255, 255, 255), kGrey(130, 130, 130), kGreen(60, 200, 60),
    kOrange(40, 140, 250), kBlue(220, 120, 40);

void caption(cv::Mat& picture, const std::string& text, cv::Point at = {10, 24}) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.6, {0, 0, 0}, 4, cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.6, kWhite, 1, cv::LINE_AA);
}

/// The left picture with its features: green with a stereo depth, orange without.
cv::Mat draw_features(const sensing::Frame& frame, const frontend::FrontendResult& result) {
  const cv::Mat gray(frame.left.height, frame.left.width, CV_8UC1,
                     const_cast<std::uint8_t*>(frame.left.pixels.data()));
  cv::Mat picture;
  cv::cvtColor(gray, picture, cv::COLOR_GRAY2BGR);
  for (const frontend::Feature& feature : result.features) {
    cv::circle(picture, cv::Point2f(feature.x, feature.y), feature.level == 0 ? 2 : 4,
               feature.disparity > 0 ? kGreen : kOrange, 1, cv::LINE_AA);
  }
  caption(picture, "localization: " + std::to_string(result.keypoints_left) + " features, " +
                       std::to_string(result.stereo_matches) + " with depth (green)");
  return picture;
}

cv::Mat draw_disparity(const depth::DisparityMap& map) {
  std::uint16_t largest = 1;
  for (const std::uint16_t value : map.values) largest = std::max(largest, value);
  cv::Mat scaled(map.height, map.width, CV_8UC1), known(map.height, map.width, CV_8UC1);
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    scaled.data[i] = static_cast<std::uint8_t>(map.values[i] * 255u / largest);
    known.data[i] = map.values[i] != 0 ? 255 : 0;
  }
  cv::Mat colours, picture(map.height, map.width, CV_8UC3, cv::Scalar(0, 0, 0));
  cv::applyColorMap(scaled, colours, cv::COLORMAP_TURBO);
  colours.copyTo(picture, known);
  caption(picture, "scene: disparity, red is near (" + std::to_string(largest / 256) + " px)");
  return picture;
}

/// Both paths from above: x to the right, z (forward) upwards, one scale for both.
cv::Mat draw_path(int width, int height, const io::Trajectory& estimate,
                  const io::Trajectory& truth) {
  cv::Mat picture(height, width, CV_8UC3, cv::Scalar(40, 36, 32));
  double x0 = 0, x1 = 0, z0 = 0, z1 = 0;
  for (const io::Trajectory* path : {&estimate, &truth}) {
    for (const Eigen::Isometry3d& pose : *path) {
      x0 = std::min(x0, pose.translation().x());
      x1 = std::max(x1, pose.translation().x());
      z0 = std::min(z0, pose.translation().z());
      z1 = std::max(z1, pose.translation().z());
    }
  }
  constexpr double kMargin = 40;
  const double scale = std::min((width - 2 * kMargin) / std::max(x1 - x0, 1.0),
                                (height - 2 * kMargin) / std::max(z1 - z0, 1.0));
  const auto draw = [&](const io::Trajectory& path, const cv::Scalar& colour, int thickness) {
    std::vector<cv::Point> points;
    for (const Eigen::Isometry3d& pose : path) {
      const double u = width / 2.0 + (pose.translation().x() - (x0 + x1) / 2) * scale;
      const double v = height - kMargin - (pose.translation().z() - z0) * scale;
      points.emplace_back(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)));
    }
    cv::polylines(picture, points, false, colour, thickness, cv::LINE_AA);
  };
  draw(truth, kGrey, 5);
  draw(estimate, kBlue, 2);
  caption(picture, truth.empty() ? "path" : "path (blue) over truth (grey)");
  // A bar of 1, 10, 100 ... metres, a third of the width at most.
  const double metres = std::pow(10, std::floor(std::log10(std::max(width / 3.0 / scale, 1.0))));
  const int bar = static_cast<int>(scale * metres);
  cv::line(picture, {20, height - 15}, {20 + bar, height - 15}, kWhite, 2);
  caption(picture, cv::format("%.0f m", metres), {28 + bar, height - 9});
  return picture;
}

/// Poses as seen from the first one, so that both paths start at the same place.
io::Trajectory from_first(const io::Trajectory& path) {
  io::Trajectory relative;
  for (const Eigen::Isometry3d& pose : path) relative.push_back(path.front().inverse() * pose);
  return relative;
}

}  // namespace

void write_overview(const std::string& path, const DepthOutput& depth,
                    const frontend::FrontendResult& features, const io::Trajectory& estimate,
                    const io::Trajectory& truth) {
  const cv::Mat left = draw_features(*depth.first_frame(), features);
  const cv::Mat below = draw_disparity(*depth.first_map());
  cv::Mat pictures, all;
  cv::vconcat(left, below, pictures);
  cv::hconcat(pictures,
              draw_path(pictures.rows / 2, pictures.rows, from_first(estimate), from_first(truth)),
              all);
  std::vector<unsigned char> bytes;
  cv::imencode(".png", all, bytes);
  io::write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace partita::app
