// OpenCV's dnn with the same network, to compare with.
#ifndef PARTITA_HOST_APP_DNN_PEER_H
#define PARTITA_HOST_APP_DNN_PEER_H

#include <memory>
#include <string>
#include <vector>

#include "host/io/darknet.h"

namespace partita::app {

class DnnPeer {
 public:
  /// With as many threads as OpenCV takes by itself. Throws Error if OpenCV does not take the file.
  DnnPeer(const std::string& cfg, const io::darknet::Model& model,
          const io::darknet::Weights& weights);
  ~DnnPeer();

  /// `picture` as DarknetNetwork::run takes it; computes what goes into the yolo layers.
  void run(const std::vector<float>& picture);
  int threads() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_DNN_PEER_H
