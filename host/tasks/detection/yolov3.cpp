#include "host/tasks/detection/yolov3.h"

#include <string>

#include <fmt/format.h>

namespace partita::detection {
namespace {

class Builder {
 public:
  void convolve(int filters, int size, int stride = 1) {
    text_ += fmt::format(
        "[convolutional]\nbatch_normalize=1\nfilters={}\nsize={}\nstride={}\npad=1\n"
        "activation=leaky\n",
        filters, size, stride);
  }

  /// Darknet-53's stage: halve the map, then `blocks` of 1x1 and 3x3 around a shortcut.
  void stage(int filters, int blocks) {
    convolve(filters, 3, 2);
    for (int i = 0; i < blocks; ++i) {
      convolve(filters / 2, 1);
      convolve(filters, 3);
      text_ += "[shortcut]\nfrom=-3\nactivation=linear\n";
    }
  }

  /// Six convolutions and a linear one that gives the boxes of one scale.
  void head(int filters, const char* mask) {
    for (int i = 0; i < 3; ++i) {
      convolve(filters, 1);
      convolve(2 * filters, 3);
    }
    text_ += fmt::format(
        "[convolutional]\nfilters=255\nsize=1\nactivation=linear\n"
        "[yolo]\nmask={}\nclasses=80\nnum=9\n"
        "anchors=10,13,16,30,33,23,30,61,62,45,59,119,116,90,156,198,373,326\n",
        mask);
  }

  /// To the next finer scale: from the fifth convolution of the head, half as many channels, twice
  /// the side, beside an earlier map.
  void refine(int filters, int earlier) {
    text_ += "[route]\nlayers=-4\n";
    convolve(filters, 1);
    text_ += fmt::format("[upsample]\nstride=2\n[route]\nlayers=-1,{}\n", earlier);
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_ = "[net]\nwidth=416\nheight=416\nchannels=3\n";
};

}  // namespace

io::darknet::Model yolov3() {
  Builder network;
  network.convolve(32, 3);
  network.stage(64, 1);
  network.stage(128, 2);
  network.stage(256, 8);
  network.stage(512, 8);
  network.stage(1024, 4);
  network.head(512, "6,7,8");
  network.refine(256, 61);
  network.head(256, "3,4,5");
  network.refine(128, 36);
  network.head(128, "0,1,2");
  return io::darknet::parse_cfg(network.text(), "yolov3");
}

}  // namespace partita::detection
