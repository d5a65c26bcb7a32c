// Final boxes of the trained networks on real pictures, against OpenCV's dnn and its NMSBoxes.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/dnn.hpp>

#include "host/io/image.h"
#include "host/runtime/device.h"
#include "host/tasks/detection/detector.h"
#include "host/tasks/detection/kernels.h"
#include "host/tasks/detection/nms.h"
#include "tests/host/detection_reference.h"
#include "tests/host/io_temp_folder.h"

namespace partita::detection {
namespace {

using testing::LoadedNetwork;

constexpr float kThreshold = 0.25F;
constexpr double kOverlap = 0.45;
constexpr float kScoreTolerance = 0.005F;

/// What OpenCV finds in a network's input, in the picture's pixels.
std::vector<Detection> reference(const LoadedNetwork& network, const std::vector<float>& input,
                                 const Placed& placed) {
  cv::dnn::Net net =
      cv::dnn::readNetFromDarknet(network.cfg_text.data(), network.cfg_text.size(),
                                  network.weight_bytes.data(), network.weight_bytes.size());
  net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  const io::darknet::Extent& size = network.model.input;
  net.setInput(cv::dnn::blobFromImage(
      cv::Mat(size.height, size.width, CV_32FC3, const_cast<float*>(input.data()))));
  std::vector<cv::Mat> outputs;
  net.forward(outputs, net.getUnconnectedOutLayersNames());
  std::vector<cv::Rect2d> boxes;
  std::vector<float> scores;
  std::vector<int> classes;
  for (const cv::Mat& rows : outputs) {
    for (int r = 0; r < rows.rows; ++r) {
      const float* row = rows.ptr<float>(r);
      const float* best = std::max_element(row + 5, row + rows.cols);
      // x, y, w, h as shares of the network's input
      const double sx = static_cast<double>(placed.picture_width) / placed.width;
      const double sy = static_cast<double>(placed.picture_height) / placed.height;
      const double width = row[2] * size.width * sx;
      const double height = row[3] * size.height * sy;
      boxes.emplace_back((row[0] * size.width - placed.left) * sx - width / 2,
                         (row[1] * size.height - placed.top) * sy - height / 2, width, height);
      scores.push_back(*best);
      classes.push_back(static_cast<int>(best - row) - 5);
    }
  }
  std::vector<Detection> found;
  for (int c = 0; c < network.model.layers.back().yolo.classes; ++c) {
    std::vector<cv::Rect2d> own_boxes;
    std::vector<float> own_scores;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (classes[i] != c) continue;
      own_boxes.push_back(boxes[i]);
      own_scores.push_back(scores[i]);
    }
    std::vector<int> kept;
    cv::dnn::NMSBoxes(own_boxes, own_scores, kThreshold, kOverlap, kept);
    for (const int k : kept) {
      const cv::Rect2d& b = own_boxes[static_cast<std::size_t>(k)];
      found.push_back(
          {{b.x, b.y, b.x + b.width, b.y + b.height}, c, own_scores[static_cast<std::size_t>(k)]});
    }
  }
  return found;
}

/// Every detection of `these` that is clear of the threshold has its like among `those`.
void expect_all_among(const std::vector<Detection>& these, const std::vector<Detection>& those,
                      const std::string& what) {
  for (const Detection& d : these) {
    if (d.score < kThreshold + kScoreTolerance) continue;
    const bool found = std::any_of(those.begin(), those.end(), [&](const Detection& e) {
      return e.object_class == d.object_class && iou(d.box, e.box) >= 0.99 &&
             std::abs(d.score - e.score) <= kScoreTolerance;
    });
    EXPECT_TRUE(found) << what << ": class " << d.object_class << ", score " << d.score << " at "
                       << d.box.left << ", " << d.box.top;
  }
}

TEST(DetectionData, TrainedNetworksFindWhatOpenCvFinds) {
  const std::string data = testing::data_folder();
  if (data.empty()) GTEST_SKIP() << "PARTITA_DATA names no folder of real data";
  const std::vector<runtime::Device> devices = runtime::find_devices();
  const auto device = std::find_if(devices.begin(), devices.end(),
                                   [](const runtime::Device& d) { return d.accepts_source; });
  ASSERT_NE(device, devices.end());
  const runtime::Session session(*device, kernel_specs(), {.variant = runtime::Variant::cpu});
  std::size_t compared = 0;
  for (const testing::TestNetwork& test : testing::test_networks()) {
    if (*test.weights == '\0') continue;
    const LoadedNetwork network = load(test, data);
    for (const Fit fit : {Fit::letterbox, Fit::stretch}) {
      Detector detector(session, network.model, network.weights,
                        {.fit = fit, .threshold = kThreshold, .overlap = kOverlap});
      for (const char* name : {"bus", "dog", "giraffe", "horses", "person", "zidane"}) {
        const auto picture = io::read_colour(data + "/detect/images/" + name + ".jpg");
        const Placed placed = place(picture.width, picture.height, network.model.input.width,
                                    network.model.input.height, fit);
        std::vector<float> input;
        fit_picture(picture, placed, input);
        const std::vector<Detection> expected = reference(network, input, placed);
        const std::vector<Detection> got = detector.detect(picture);
        const std::string what = std::string(test.name) + " " + name;
        expect_all_among(got, expected, what + ", ours");
        expect_all_among(expected, got, what + ", OpenCV's");
        compared += got.size();
      }
    }
  }
  EXPECT_GT(compared, 100U);
}

}  // namespace
}  // namespace partita::detection
