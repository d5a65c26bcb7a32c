#include "host/tasks/detection/decode.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "host/tasks/detection/curves.h"

// Sums and products stay apart, so that every machine has the same bits; see CMakeLists.txt.
namespace partita::detection {

namespace {

/// One scale's boxes.
class Scale {
 public:
  Scale(const io::darknet::Model& model, const RawOutput& output, const Placed& placed,
        float threshold)
      : yolo_(model.layers[output.layer].yolo),
        input_(model.input),
        output_(output),
        placed_(placed),
        threshold_(threshold) {}

  void add_to(std::vector<Detection>& detections) const {
    const auto entries = static_cast<std::size_t>(5 + yolo_.classes);
    for (int y = 0; y < output_.height; ++y) {
      for (int x = 0; x < output_.width; ++x) {
        for (std::size_t a = 0; a < yolo_.mask.size(); ++a) {
          add_box(x, y, yolo_.anchors[static_cast<std::size_t>(yolo_.mask[a])],
                  {output_.cell(x, y) + a * entries, entries}, detections);
        }
      }
    }
  }

 private:
  void add_box(int x, int y, const io::darknet::Yolo::Anchor& anchor, std::span<const float> t,
               std::vector<Detection>& detections) const {
    const float objectness = logistic(t[4]);
    if (!(objectness > threshold_)) return;  // nor is the score, then
    const auto best = std::max_element(t.begin() + 5, t.end());
    const float score = objectness * logistic(*best);
    const bool finite = std::all_of(t.begin(), t.end(), [](float v) { return std::isfinite(v); });
    if (!(score > threshold_) || !finite) return;
    const double s = yolo_.scale_x_y;
    const double shift = 0.5 * (s - 1.0);
    const double centre_x = (x + s * logistic(t[0]) - shift) * input_.width / output_.width;
    const double centre_y = (y + s * logistic(t[1]) - shift) * input_.height / output_.height;
    const double half_width = 0.5 * anchor.width * exp_80(std::clamp(t[2], -80.0F, 80.0F));
    const double half_height = 0.5 * anchor.height * exp_80(std::clamp(t[3], -80.0F, 80.0F));
    const Box box{to_picture_x(centre_x - half_width), to_picture_y(centre_y - half_height),
                  to_picture_x(centre_x + half_width), to_picture_y(centre_y + half_height)};
    detections.push_back({box, static_cast<int>(best - t.begin()) - 5, score});
  }

  double to_picture_x(double x) const {
    return (x - placed_.left) * placed_.picture_width / placed_.width;
  }
  double to_picture_y(double y) const {
    return (y - placed_.top) * placed_.picture_height / placed_.height;
  }

  const io::darknet::Yolo& yolo_;
  const io::darknet::Extent& input_;
  const RawOutput& output_;
  const Placed& placed_;
  float threshold_;
};

}  // namespace

double intersection(const Box& a, const Box& b) {
  const double width = std::min(a.right, b.right) - std::max(a.left, b.left);
  const double height = std::min(a.bottom, b.bottom) - std::max(a.top, b.top);
  return width > 0 && height > 0 ? width * height : 0.0;
}

double iou(const Box& a, const Box& b) {
  const double common = intersection(a, b);
  const double both = a.area() + b.area() - common;
  return both > 0 ? common / both : 0.0;
}

Box clipped(const Box& box, int picture_width, int picture_height) {
  const auto x = [w = static_cast<double>(picture_width)](double v) {
    return std::clamp(v, 0.0, w);
  };
  const auto y = [h = static_cast<double>(picture_height)](double v) {
    return std::clamp(v, 0.0, h);
  };
  return {x(box.left), y(box.top), x(box.right), y(box.bottom)};
}

std::vector<Detection> decode(const io::darknet::Model& model,
                              const std::vector<RawOutput>& outputs, const Placed& placed,
                              float threshold) {
  std::vector<Detection> detections;
  for (const RawOutput& output : outputs) {
    Scale(model, output, placed, threshold).add_to(detections);
  }
  return detections;
}

}  // namespace partita::detection
