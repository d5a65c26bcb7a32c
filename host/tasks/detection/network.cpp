#include "host/tasks/detection/network.h"

namespace partita::detection {
namespace {

constexpr std::int64_t kBoxes = kAnchors * kBoxEntries;

class Builder {
 public:
  void convolve(std::int64_t outputs, std::int64_t kernel, std::int64_t stride = 1,
                bool shortcut = false) {
    side_ /= stride;
    layers_.push_back({.side = side_,
                       .inputs = channels_,
                       .outputs = outputs,
                       .kernel = kernel,
                       .stride = stride,
                       .shortcut = shortcut});
    channels_ = outputs;
  }

  /// Darknet-53's stage: halve the map, then `blocks` of 1x1 and 3x3 around a shortcut.
  void stage(std::int64_t outputs, int blocks) {
    convolve(outputs, 3, 2);
    for (int i = 0; i < blocks; ++i) {
      convolve(outputs / 2, 1);
      convolve(outputs, 3, 1, true);
    }
  }

  /// Six convolutions and a linear one that gives the boxes of one scale; the next scale branches
  /// off after the fifth.
  void head(std::int64_t outputs) {
    for (int i = 0; i < 3; ++i) {
      convolve(outputs, 1);
      convolve(2 * outputs, 3);
    }
    convolve(kBoxes, 1);
    layers_.push_back(
        {.kind = LayerKind::decode, .side = side_, .inputs = kBoxes, .outputs = kBoxes});
    channels_ = outputs;
  }

  /// To the next finer scale: half as many channels, twice the side, beside an earlier map.
  void refine(std::int64_t earlier) {
    convolve(channels_ / 2, 1);
    side_ *= 2;
    layers_.push_back(
        {.kind = LayerKind::upsample, .side = side_, .inputs = channels_, .outputs = channels_});
    channels_ += earlier;
  }

  std::vector<Layer> take() { return std::move(layers_); }

 private:
  std::vector<Layer> layers_;
  std::int64_t side_ = kNetworkSide, channels_ = 3;
};

}  // namespace

std::vector<Layer> yolov3_layers() {
  Builder network;
  network.convolve(32, 3);
  network.stage(64, 1);
  network.stage(128, 2);
  network.stage(256, 8);
  network.stage(512, 8);
  network.stage(1024, 4);
  network.head(512);
  network.refine(512);
  network.head(256);
  network.refine(256);
  network.head(128);
  return network.take();
}

}  // namespace partita::detection
