// From a picture to boxes: the network with the host steps before and behind it.
#ifndef PARTITA_HOST_TASKS_DETECTION_DETECTOR_H
#define PARTITA_HOST_TASKS_DETECTION_DETECTOR_H

#include <vector>

#include "host/tasks/detection/darknet_network.h"
#include "host/tasks/detection/decode.h"
#include "host/tasks/detection/letterbox.h"

namespace partita::detection {

struct DetectorOptions {
  Fit fit = Fit::letterbox;
  float threshold = 0.25F;  ///< scores above it count
  double overlap = 0.45;    ///< the largest IoU of two boxes of one class
};

class Detector {
 public:
  /// `session` as for DarknetNetwork.
  Detector(const runtime::Session& session, io::darknet::Model model,
           const io::darknet::Weights& weights, const DetectorOptions& options);

  /// By falling score.
  std::vector<Detection> detect(const sensing::ColourImage& picture);

  const DarknetNetwork& network() const { return network_; }
  void warm_up() { network_.warm_up(); }

 private:
  const runtime::Session& session_;
  DarknetNetwork network_;
  DetectorOptions options_;
  std::vector<float> input_;
};

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_DETECTOR_H
