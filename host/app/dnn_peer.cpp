#include "host/app/dnn_peer.h"

#include <regex>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/dnn.hpp>

#include "host/io/file.h"
#include "host/runtime/error.h"

namespace partita::app {

struct DnnPeer::Impl {
  cv::dnn::Net net;
  std::vector<cv::String> outputs;
  io::darknet::Extent size;
};

DnnPeer::DnnPeer(const std::string& cfg, const io::darknet::Model& model,
                 const io::darknet::Weights& weights)
    : impl_(std::make_unique<Impl>()) {
  std::string text = io::read_file(cfg);
  const auto set = [&](const char* key, int value) {
    const std::regex line(fmt::format("(^|\n)[ \t]*{}[ \t]*=[ \t]*[0-9]+", key));
    text = std::regex_replace(text, line, fmt::format("$1{}={}", key, value),
                              std::regex_constants::format_first_only);
  };
  set("width", model.input.width);
  set("height", model.input.height);
  const std::string bytes = io::darknet::format_weights(weights);
  impl_->size = model.input;
  try {
    impl_->net = cv::dnn::readNetFromDarknet(text.data(), text.size(), bytes.data(), bytes.size());
  } catch (const cv::Exception& error) {
    throw Error(fmt::format("{}: OpenCV does not take it: {}", cfg, error.err));
  }
  impl_->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  for (std::size_t i = 0; i < model.layers.size(); ++i) {
    if (model.layers[i].kind == io::darknet::LayerKind::yolo) {
      impl_->outputs.push_back(fmt::format("conv_{}", i - 1));
    }
  }
}

DnnPeer::~DnnPeer() = default;

void DnnPeer::run(const std::vector<float>& picture) {
  const cv::Mat image(impl_->size.height, impl_->size.width, CV_32FC(impl_->size.channels),
                      const_cast<float*>(picture.data()));
  impl_->net.setInput(cv::dnn::blobFromImage(image));
  std::vector<cv::Mat> results;
  impl_->net.forward(results, impl_->outputs);
}

int DnnPeer::threads() const {
  return cv::getNumThreads();
}

}  // namespace partita::app
