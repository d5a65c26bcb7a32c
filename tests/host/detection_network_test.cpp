// Whole networks on the first OpenCL device that takes source, against OpenCV's dnn.
#include <cmath>
#include <regex>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/dnn.hpp>

#include "host/runtime/device.h"
#include "host/tasks/detection/darknet_network.h"
#include "host/tasks/detection/kernels.h"
#include "tests/host/darknet_networks.h"
#include "tests/host/detection_reference.h"
#include "tests/host/io_temp_folder.h"

namespace partita::detection {
namespace {

using runtime::Session;
using runtime::Variant;
using testing::LoadedNetwork;
using testing::TestNetwork;

runtime::Device source_device() {
  for (const runtime::Device& device : runtime::find_devices()) {
    if (device.accepts_source) return device;
  }
  throw std::runtime_error("no OpenCL device that takes source");
}

Session session_of(Variant variant) {
  return Session(source_device(), kernel_specs(), {.variant = variant});
}

/// OpenCV's numbers of what goes into the yolo layers: [channel][y][x] of the layer before each.
class Reference {
 public:
  explicit Reference(const LoadedNetwork& network)
      : net_(cv::dnn::readNetFromDarknet(network.cfg_text.data(), network.cfg_text.size(),
                                         network.weight_bytes.data(),
                                         network.weight_bytes.size())) {
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    for (std::size_t i = 0; i < network.model.layers.size(); ++i) {
      if (network.model.layers[i].kind == io::darknet::LayerKind::yolo) {
        names_.push_back(fmt::format("conv_{}", i - 1));
      }
    }
  }

  std::vector<cv::Mat> run(const std::vector<float>& picture, const io::darknet::Extent& size) {
    const cv::Mat image(size.height, size.width, CV_32FC3, const_cast<float*>(picture.data()));
    net_.setInput(cv::dnn::blobFromImage(image));
    std::vector<cv::Mat> outputs;
    net_.forward(outputs, names_);
    return outputs;
  }

 private:
  cv::dnn::Net net_;
  std::vector<cv::String> names_;
};

/// Largest difference over the tensor's root mean square.
double difference(const RawOutput& got, const cv::Mat& expected) {
  double largest = 0, squares = 0;
  const auto* e = expected.ptr<float>();
  for (int c = 0; c < got.channels; ++c) {
    for (int y = 0; y < got.height; ++y) {
      for (int x = 0; x < got.width; ++x, ++e) {
        const double error = std::abs(static_cast<double>(got.cell(x, y)[c]) - *e);
        largest = std::max(largest, std::isnan(error) ? INFINITY : error);
        squares += static_cast<double>(*e) * *e;
      }
    }
  }
  return largest / std::sqrt(squares / static_cast<double>(got.values.size()));
}

void expect_opencvs_numbers(const LoadedNetwork& network) {
  const std::vector<float> picture = testing::test_picture(network.model.input);
  const std::vector<cv::Mat> expected = Reference(network).run(picture, network.model.input);
  const Session session = session_of(Variant::cpu);
  DarknetNetwork ours(session, network.model, network.weights);
  const std::vector<RawOutput> outputs = ours.run(picture);
  ASSERT_EQ(outputs.size(), expected.size());
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const RawOutput& out = outputs[i];
    ASSERT_EQ(expected[i].total(), out.values.size());
    ASSERT_EQ(expected[i].size[1], out.channels);
    ASSERT_EQ(expected[i].size[2], out.height);
    EXPECT_LT(difference(out, expected[i]), 1e-3) << "layer " << out.layer;
  }
  // Memory is shared, and a second run finds nothing of the first.
  EXPECT_EQ(ours.run(picture)[0].values, outputs[0].values);
}

LoadedNetwork every_layer(const char* relu6) {
  LoadedNetwork network;
  network.cfg_text = std::regex_replace(testing::kEveryLayerCfg, std::regex("relu6"), relu6);
  network.model = io::darknet::parse_cfg(network.cfg_text, "net.cfg");
  network.weights = io::darknet::random_weights(network.model, 1);
  network.weight_bytes = io::darknet::format_weights(network.weights);
  return network;
}

/// OpenCV 4.6 does not know relu6 in a .cfg.
TEST(Network, OfEveryLayerGivesOpenCvsNumbers) {
  expect_opencvs_numbers(every_layer("relu"));
}

TEST(Network, GivesTheSameBytesInEveryVariant) {
  const LoadedNetwork network = every_layer("relu6");
  const std::vector<float> picture = testing::test_picture(network.model.input);
  std::vector<std::vector<float>> first;
  for (const Variant variant : runtime::kVariants) {
    const Session session = session_of(variant);
    DarknetNetwork ours(session, network.model, network.weights);
    std::vector<std::vector<float>> values;
    for (const RawOutput& out : ours.run(picture)) values.push_back(out.values);
    if (first.empty()) first = values;
    EXPECT_EQ(values, first) << to_string(variant);
  }
}

TEST(Network, RefusesAPictureOfAnotherSize) {
  const LoadedNetwork network = every_layer("relu6");
  const Session session = session_of(Variant::cpu);
  DarknetNetwork ours(session, network.model, network.weights);
  EXPECT_EQ(testing::error_of([&] { ours.run(std::vector<float>(12)); }),
            "net.cfg: a picture of 12 numbers, expected 52 x 36 x 3");
}

class Networks : public ::testing::TestWithParam<TestNetwork> {};

TEST_P(Networks, GiveOpenCvsNumbers) {
  const std::string data = testing::data_folder();
  if (data.empty()) GTEST_SKIP() << "PARTITA_DATA names no folder of real data";
  expect_opencvs_numbers(load(GetParam(), data));
}

INSTANTIATE_TEST_SUITE_P(All, Networks, ::testing::ValuesIn(testing::test_networks()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace partita::detection
