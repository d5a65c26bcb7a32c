// Detection beside OpenCV's dnn: the same network, numbers and picture.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <opencv2/core/version.hpp>
#include <opencv2/dnn.hpp>

#include "host/app/bench_peers.h"
#include "host/app/environment.h"
#include "host/io/darknet.h"
#include "host/io/file.h"
#include "host/runtime/device.h"
#include "host/runtime/error.h"
#include "host/tasks/detection/detector.h"
#include "host/tasks/detection/kernels.h"
#include "host/tasks/sensing/frame.h"

namespace partita::app {
namespace {

using detection::Detection;
using io::darknet::Model;
using io::darknet::Weights;

constexpr double kOverlap = 0.45;
constexpr std::size_t kCandidates = 100;  // boxes above the threshold, as on a busy street

struct Network {
  Model model;
  Weights weights;
  std::string cfg_text, weight_bytes;  // for OpenCV
  bool random = false;
};

Network read_network(const std::string& cfg, const std::string& weights) {
  Network network;
  network.cfg_text = io::read_file(cfg);
  network.model = io::darknet::read_cfg(cfg);
  network.random = weights.empty();
  if (network.random) {
    network.weights = io::darknet::random_weights(network.model, 1);
    network.weight_bytes = io::darknet::format_weights(network.weights);
  } else {
    network.weights = io::darknet::read_weights(weights, network.model);
    network.weight_bytes = io::read_file(weights);
  }
  return network;
}

sensing::ColourImage picture_of(const sensing::FrameSource& source) {
  const sensing::Frame frame = source.frame(0);
  sensing::ColourImage picture(frame.left.width, frame.left.height);
  std::transform(frame.left.pixels.begin(), frame.left.pixels.end(), picture.pixels.begin(),
                 [](std::uint8_t v) {
                   return sensing::Rgb{v, v, v};
                 });
  return picture;
}

/// The score that so many boxes exceed: random numbers would let thousands pass a usual threshold.
float threshold_for(const Model& model, const std::vector<detection::RawOutput>& outputs,
                    const detection::Placed& placed) {
  std::vector<Detection> all = detection::decode(model, outputs, placed, 0.0F);
  if (all.size() <= kCandidates) return 0.25F;
  std::nth_element(all.begin(), all.begin() + kCandidates, all.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  return all[kCandidates].score;
}

/// OpenCV as its own examples use it: a blob, a forward pass, the best class of each row, NMSBoxes
/// class by class.
class OpenCv {
 public:
  OpenCv(const Network& network, float threshold)
      : net_(cv::dnn::readNetFromDarknet(network.cfg_text.data(), network.cfg_text.size(),
                                         network.weight_bytes.data(), network.weight_bytes.size())),
        size_(network.model.input.width, network.model.input.height),
        threshold_(threshold) {
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    names_ = net_.getUnconnectedOutLayersNames();
  }

  std::vector<Detection> detect(const sensing::ColourImage& picture) {
    const cv::Mat image(picture.height, picture.width, CV_8UC3,
                        const_cast<sensing::Rgb*>(picture.pixels.data()));
    cv::dnn::blobFromImage(image, blob_, 1.0 / 255, size_);
    net_.setInput(blob_);
    net_.forward(outputs_, names_);
    std::vector<std::vector<cv::Rect2d>> boxes;
    std::vector<std::vector<float>> scores;
    for (const cv::Mat& rows : outputs_) {
      boxes.resize(static_cast<std::size_t>(rows.cols) - 5);
      scores.resize(boxes.size());
      for (int r = 0; r < rows.rows; ++r) {
        const float* row = rows.ptr<float>(r);
        const float* best = std::max_element(row + 5, row + rows.cols);
        if (*best <= threshold_) continue;
        const auto c = static_cast<std::size_t>(best - row) - 5;
        const double width = row[2] * picture.width;
        const double height = row[3] * picture.height;
        boxes[c].emplace_back(row[0] * picture.width - width / 2,
                              row[1] * picture.height - height / 2, width, height);
        scores[c].push_back(*best);
      }
    }
    std::vector<Detection> found;
    for (std::size_t c = 0; c < boxes.size(); ++c) {
      cv::dnn::NMSBoxes(boxes[c], scores[c], threshold_, kOverlap, kept_);
      for (const int k : kept_) {
        const cv::Rect2d& b = boxes[c][static_cast<std::size_t>(k)];
        found.push_back({{b.x, b.y, b.x + b.width, b.y + b.height},
                         static_cast<int>(c),
                         scores[c][static_cast<std::size_t>(k)]});
      }
    }
    return found;
  }

 private:
  cv::dnn::Net net_;
  cv::Size size_;
  float threshold_;
  std::vector<cv::String> names_;
  cv::Mat blob_;
  std::vector<cv::Mat> outputs_;
  std::vector<int> kept_;
};

/// How many of `these` have their like among `those`.
std::size_t alike(const std::vector<Detection>& these, const std::vector<Detection>& those) {
  return static_cast<std::size_t>(
      std::count_if(these.begin(), these.end(), [&](const Detection& d) {
        return std::any_of(those.begin(), those.end(), [&](const Detection& e) {
          return d.object_class == e.object_class && detection::iou(d.box, e.box) >= 0.99 &&
                 std::abs(d.score - e.score) <= 0.005F;
        });
      }));
}

PeerComparison compare(const std::string& task, const Network& network, const PeerOptions& options,
                       const RoundDone& done) {
  const auto source = sensing::open_scenario({});
  const sensing::ColourImage picture = picture_of(*source);
  set_emulation({.machine = kNativeMachine});
  const runtime::Device device = runtime::select_device(runtime::find_devices(), "cpu");
  const runtime::Session session(device, detection::kernel_specs(),
                                 {.variant = runtime::Variant::cpu});
  const io::darknet::Extent& size = network.model.input;
  float threshold = 0.25F;
  if (network.random) {
    const detection::Placed placed = detection::place(picture.width, picture.height, size.width,
                                                      size.height, detection::Fit::stretch);
    std::vector<float> input;
    detection::fit_picture(picture, placed, input);
    detection::DarknetNetwork once(session, network.model, network.weights);
    threshold = threshold_for(network.model, once.run(input), placed);
  }
  detection::Detector detector(
      session, network.model, network.weights,
      {.fit = detection::Fit::stretch, .threshold = threshold, .overlap = kOverlap});
  cv::setNumThreads(static_cast<int>(options.cores));
  OpenCv peer(network, threshold);
  std::vector<Detection> ours;
  std::vector<Detection> theirs;
  const std::vector<std::function<void()>> contestants{[&] { ours = detector.detect(picture); },
                                                       [&] { theirs = peer.detect(picture); }};
  const auto ms = time_in_turns(contestants, options.rounds, done);

  PeerComparison comparison{
      .task = task,
      .input = fmt::format("first frame of {}, {}x{}, stretched to {}x{}", source->name(),
                           picture.width, picture.height, size.width, size.height),
      .timed = "from picture to boxes, both in host memory"};
  comparison.ours = {
      "partita detect",
      fmt::format("CPU variant on {}{}, scores above {:.3f}, overlap {}", device.name,
                  network.random ? ", random weights (seed 1)" : "", threshold, kOverlap),
      ms[0],
      {{"boxes", ours.size()}},
      fmt::format("{} boxes", ours.size())};
  const std::size_t same = alike(theirs, ours);
  comparison.peers = {
      {"cv::dnn",
       fmt::format("OpenCV {}, {} threads, NMSBoxes for each class", CV_VERSION, options.cores),
       ms[1],
       {{"boxes", theirs.size()}, {"same_as_ours", same}},
       fmt::format("{} boxes, {} the same", theirs.size(), same)}};
  return comparison;
}

}  // namespace

PeerComparison compare_yolov3(const PeerOptions& options, const RoundDone& done) {
  return compare("yolov3", read_network(options.networks + "/cfg_only/yolov3.cfg", ""), options,
                 done);
}

PeerComparison compare_yolov3_tiny(const PeerOptions& options, const RoundDone& done) {
  return compare("yolov3-tiny", read_network(options.networks + "/cfg_only/yolov3-tiny.cfg", ""),
                 options, done);
}

PeerComparison compare_yolo_fastest(const PeerOptions& options, const RoundDone& done) {
  const std::string stem = options.networks + "/yolo-fastest-1.1_coco/yolo-fastest-1.1";
  return compare("yolo-fastest", read_network(stem + ".cfg", stem + ".weights"), options, done);
}

PeerComparison compare_yolo_fastest_xl(const PeerOptions& options, const RoundDone& done) {
  const std::string stem = options.networks + "/yolo-fastest-1.1_coco/yolo-fastest-1.1-xl";
  return compare("yolo-fastest-xl", read_network(stem + ".cfg", stem + ".weights"), options, done);
}

PeerComparison compare_street(const PeerOptions& options, const RoundDone& done) {
  const std::string stem = places().profiles + "/detectors/street/street";
  return compare("street", read_network(stem + ".cfg", stem + ".weights"), options, done);
}

}  // namespace partita::app
