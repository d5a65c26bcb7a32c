#include "tests/host/detection_reference.h"

#include <cmath>
#include <regex>

#include <fmt/format.h>

#include "host/io/file.h"

namespace partita::testing {

const std::vector<TestNetwork>& test_networks() {
  static const std::vector<TestNetwork> networks = {
      {"fastest_1_0", "yolo-fastest-1.0_coco/yolo-fastest.cfg",
       "yolo-fastest-1.0_coco/yolo-fastest.weights"},
      {"fastest_1_0_xl", "yolo-fastest-1.0_coco/yolo-fastest-xl.cfg",
       "yolo-fastest-1.0_coco/yolo-fastest-xl.weights"},
      {"fastest_1_1", "yolo-fastest-1.1_coco/yolo-fastest-1.1.cfg",
       "yolo-fastest-1.1_coco/yolo-fastest-1.1.weights"},
      {"fastest_1_1_xl", "yolo-fastest-1.1_coco/yolo-fastest-1.1-xl.cfg",
       "yolo-fastest-1.1_coco/yolo-fastest-1.1-xl.weights"},
      {"mobilenet_nano", "MobileNetV2-YOLOv3-Nano/COCO/MobileNetV2-YOLOv3-Nano-coco.cfg",
       "MobileNetV2-YOLOv3-Nano/COCO/MobileNetV2-YOLOv3-Nano-coco.weights"},
      {"yolov3_tiny", "cfg_only/yolov3-tiny.cfg", "", 224},
      {"yolov4_tiny", "cfg_only/yolov4-tiny.cfg", "", 224},
      {"yolov3", "cfg_only/yolov3.cfg", "", 96}};
  return networks;
}

LoadedNetwork load(const TestNetwork& network, const std::string& data_folder) {
  const std::string folder = data_folder + "/detect/";
  LoadedNetwork loaded;
  loaded.cfg_text = io::read_file(folder + network.cfg);
  if (network.side != 0) {
    const std::string side = fmt::format("$1={}", network.side);
    loaded.cfg_text =
        std::regex_replace(loaded.cfg_text, std::regex("(width|height) *= *[0-9]+"), side);
  }
  loaded.model = io::darknet::parse_cfg(loaded.cfg_text, network.cfg);
  if (*network.weights != '\0') {
    loaded.weight_bytes = io::read_file(folder + network.weights);
    loaded.weights = io::darknet::parse_weights(loaded.weight_bytes, network.weights, loaded.model);
  } else {
    loaded.weights = io::darknet::random_weights(loaded.model, 1);
    loaded.weight_bytes = io::darknet::format_weights(loaded.weights);
  }
  return loaded;
}

std::vector<float> test_picture(const io::darknet::Extent& size) {
  std::vector<float> picture;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      for (int c = 0; c < size.channels; ++c) {
        const auto phase = static_cast<float>(x * (c + 1) + 2 * y);
        const float grain = static_cast<float>((x * 7919 + y * 104729 + c * 13) % 97) / 97;
        picture.push_back(0.5F + 0.3F * std::sin(phase / 17) + 0.2F * (grain - 0.5F));
      }
    }
  }
  return picture;
}

}  // namespace partita::testing
