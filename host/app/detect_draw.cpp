// Boxes and names in a picture.
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "host/app/detect.h"

namespace partita::app {
namespace {

// Colours that stay apart for people who see fewer of them (Okabe and Ito); red, green, blue.
const std::array<cv::Scalar, 7> kColours = {cv::Scalar(230, 159, 0),  cv::Scalar(86, 180, 233),
                                            cv::Scalar(0, 158, 115),  cv::Scalar(240, 228, 66),
                                            cv::Scalar(0, 114, 178),  cv::Scalar(213, 94, 0),
                                            cv::Scalar(204, 121, 167)};

}  // namespace

void draw_detections(sensing::ColourImage& picture,
                     const std::vector<detection::Detection>& detections,
                     const std::vector<std::string>& names) {
  cv::Mat canvas(picture.height, picture.width, CV_8UC3, picture.pixels.data());
  const int thickness = std::max(1, std::max(picture.width, picture.height) / 500);
  const double size = std::max(0.35, std::max(picture.width, picture.height) / 2000.0);
  for (std::size_t i = detections.size(); i-- > 0;) {  // the best one on top
    const detection::Detection& d = detections[i];
    const detection::Box box = detection::clipped(d.box, picture.width, picture.height);
    const cv::Scalar& colour = kColours[static_cast<std::size_t>(d.object_class) % kColours.size()];
    const cv::Point low(static_cast<int>(box.left), static_cast<int>(box.top));
    const cv::Point high(static_cast<int>(box.right), static_cast<int>(box.bottom));
    cv::rectangle(canvas, low, high, colour, thickness, cv::LINE_AA);

    const std::string text =
        fmt::format("{} {:.2f}", names[static_cast<std::size_t>(d.object_class)], d.score);
    int below = 0;
    const cv::Size extent = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, &below);
    const int height = extent.height + below + 2;
    const cv::Point corner(std::clamp(low.x, 0, std::max(0, picture.width - extent.width)),
                           low.y >= height ? low.y - height : low.y);
    cv::rectangle(canvas, cv::Rect(corner, cv::Size(extent.width + 2, height)), colour, cv::FILLED);
    cv::putText(canvas, text, corner + cv::Point(1, extent.height + 1), cv::FONT_HERSHEY_SIMPLEX,
                size, cv::Scalar::all(0), 1, cv::LINE_AA);
  }
}

}  // namespace partita::app
