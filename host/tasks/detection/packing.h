// Weights as the kernels take them: batch normalisation folded in, channels side by side.
#ifndef PARTITA_HOST_TASKS_DETECTION_PACKING_H
#define PARTITA_HOST_TASKS_DETECTION_PACKING_H

#include <vector>

#include "host/io/darknet.h"

namespace partita::detection {

struct PackedWeights {
  std::vector<float> weights, bias;
};

/// [block][ky][kx][input][lane] of one group, the last block filled up with zeros.
PackedWeights pack_convolution(const io::darknet::Layer& layer,
                               const io::darknet::LayerWeights& weights, int group, int lanes);

/// [ky][kx][channel].
PackedWeights pack_depthwise(const io::darknet::Layer& layer,
                             const io::darknet::LayerWeights& weights);

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_PACKING_H
