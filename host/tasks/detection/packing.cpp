#include "host/tasks/detection/packing.h"

#include <cmath>
#include <cstddef>

namespace partita::detection {
namespace {

using io::darknet::Layer;
using io::darknet::LayerWeights;

/// Keeps a channel whose variance is zero finite; the same as in other readers of these files.
constexpr double kEpsilon = 1e-6;

struct Fold {
  double scale = 1, bias = 0;
};

/// scale (x - mean) / sqrt(variance) + bias, as one multiplication and one addition.
Fold fold_of(const Layer& layer, const LayerWeights& w, std::size_t output) {
  if (!layer.batch_normalize) return {1, w.biases[output]};
  const double scale = w.scales[output] / std::sqrt(w.variances[output] + kEpsilon);
  return {scale, w.biases[output] - w.means[output] * scale};
}

}  // namespace

PackedWeights pack_convolution(const Layer& layer, const LayerWeights& w, int group, int lanes) {
  const auto inputs = static_cast<std::size_t>(layer.in.channels / layer.groups);
  const auto outputs = static_cast<std::size_t>(layer.out.channels / layer.groups);
  const auto window = static_cast<std::size_t>(layer.size * layer.size);
  const auto width = static_cast<std::size_t>(lanes);
  const std::size_t blocks = (outputs + width - 1) / width;
  PackedWeights packed{std::vector<float>(blocks * width * window * inputs),
                       std::vector<float>(blocks * width)};
  for (std::size_t c = 0; c < outputs; ++c) {
    const std::size_t output = static_cast<std::size_t>(group) * outputs + c;
    const Fold fold = fold_of(layer, w, output);
    packed.bias[c] = static_cast<float>(fold.bias);
    float* block = &packed.weights[c / width * width * window * inputs + c % width];
    const float* from = &w.weights[output * inputs * window];
    for (std::size_t i = 0; i < inputs; ++i) {
      for (std::size_t k = 0; k < window; ++k) {
        block[(k * inputs + i) * width] = static_cast<float>(*from++ * fold.scale);
      }
    }
  }
  return packed;
}

PackedWeights pack_depthwise(const Layer& layer, const LayerWeights& w) {
  const auto channels = static_cast<std::size_t>(layer.out.channels);
  const auto window = static_cast<std::size_t>(layer.size * layer.size);
  PackedWeights packed{std::vector<float>(channels * window), std::vector<float>(channels)};
  for (std::size_t c = 0; c < channels; ++c) {
    const Fold fold = fold_of(layer, w, c);
    packed.bias[c] = static_cast<float>(fold.bias);
    for (std::size_t k = 0; k < window; ++k) {
      packed.weights[k * channels + c] = static_cast<float>(w.weights[c * window + k] * fold.scale);
    }
  }
  return packed;
}

}  // namespace partita::detection
