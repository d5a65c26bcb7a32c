#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include <fmt/format.h>

#include "host/io/darknet.h"
#include "host/io/file.h"
#include "host/runtime/error.h"

namespace partita::io::darknet {
namespace {

constexpr std::size_t kVersionBytes = 12;  // major, minor, revision

std::int32_t integer_at(std::string_view bytes, std::size_t offset) {
  std::int32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// From version 0.2 on, the number of pictures seen in training has 64 bits.
std::size_t header_bytes(std::string_view bytes, const std::string& path) {
  if (bytes.size() < kVersionBytes) {
    throw Error(fmt::format("{}: {} bytes, expected a header of at least {}", path, bytes.size(),
                            kVersionBytes + 4));
  }
  const std::int32_t major = integer_at(bytes, 0), minor = integer_at(bytes, 4);
  if (major < 0 || minor < 0 || major > 1000 || minor > 1000) {
    throw Error(
        fmt::format("{}: version {}.{}, expected that of a .weights file", path, major, minor));
  }
  return kVersionBytes + (major * 10 + minor >= 2 ? 8 : 4);
}

/// Sizes of a convolution's arrays, in the order of the file.
struct Counts {
  std::size_t filters = 0, weights = 0;
  bool batch_normalize = false;

  std::size_t total() const { return filters * (batch_normalize ? 4 : 1) + weights; }
};

Counts counts_of(const Layer& layer) {
  if (layer.kind != LayerKind::convolutional) return {};
  const auto filters = static_cast<std::size_t>(layer.out.channels);
  const auto window = static_cast<std::size_t>(layer.size * layer.size);
  const auto inputs = static_cast<std::size_t>(layer.in.channels / layer.groups);
  return {filters, filters * inputs * window, layer.batch_normalize};
}

class NumberReader {
 public:
  NumberReader(std::string_view bytes, std::string where)
      : bytes_(bytes), path_(std::move(where)) {}

  std::vector<float> take(std::size_t count, std::size_t layer, const char* what) {
    if (count == 0) return {};
    std::vector<float> values(count);
    std::memcpy(values.data(), bytes_.data(), count * sizeof(float));
    bytes_.remove_prefix(count * sizeof(float));
    for (std::size_t i = 0; i < count; ++i) {
      if (std::isfinite(values[i])) continue;
      throw Error(fmt::format("{}: layer {}: {} {} of {} is {}, expected a finite number", path_,
                              layer, what, i, count, values[i]));
    }
    return values;
  }

 private:
  std::string_view bytes_;
  std::string path_;
};

void check_size(std::size_t floats, std::size_t rest, const std::string& path, const Model& model) {
  std::size_t expected = 0;
  for (std::size_t i = 0; i < model.layers.size(); ++i) {
    const std::size_t count = counts_of(model.layers[i]).total();
    expected += count;
    if (count > 0 && expected > floats) {
      throw Error(fmt::format("{}: ends in layer {} ({}:{}): {} numbers, expected {} up to its end",
                              path, i, model.path, model.layers[i].line, floats, expected));
    }
  }
  if (expected < floats || rest != 0) {
    throw Error(
        fmt::format("{}: {} bytes more than the {} numbers of {}: weights of another "
                    "network",
                    path, (floats - expected) * sizeof(float) + rest, expected, model.path));
  }
}

}  // namespace

Weights parse_weights(std::string_view bytes, const std::string& path, const Model& model) {
  const std::size_t header = header_bytes(bytes, path);
  if (bytes.size() < header) {
    throw Error(fmt::format("{}: {} bytes, expected a header of {}", path, bytes.size(), header));
  }
  bytes.remove_prefix(header);
  check_size(bytes.size() / sizeof(float), bytes.size() % sizeof(float), path, model);
  NumberReader reader(bytes, path);
  Weights all(model.layers.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Counts count = counts_of(model.layers[i]);
    LayerWeights& layer = all[i];
    layer.biases = reader.take(count.filters, i, "bias");
    if (count.batch_normalize) {
      layer.scales = reader.take(count.filters, i, "scale");
      layer.means = reader.take(count.filters, i, "mean");
      layer.variances = reader.take(count.filters, i, "variance");
      const auto negative = std::find_if(layer.variances.begin(), layer.variances.end(),
                                         [](float v) { return v < 0; });
      if (negative != layer.variances.end()) {
        throw Error(fmt::format("{}: layer {}: variance {} is {}, expected no negative number",
                                path, i, negative - layer.variances.begin(), *negative));
      }
    }
    layer.weights = reader.take(count.weights, i, "weight");
  }
  return all;
}

Weights read_weights(const std::string& path, const Model& model) {
  return parse_weights(read_file(path), path, model);
}

Weights random_weights(const Model& model, std::uint32_t seed) {
  std::mt19937 random(seed);
  // Not std::normal_distribution, whose numbers differ between libraries: a sum of four uniform
  // ones, of variance 1.
  const auto uniform = [&random] { return static_cast<float>(random()) * 0x1p-32F; };
  const auto normal = [&uniform] {
    return (uniform() + uniform() + uniform() + uniform() - 2) * 1.7320508F;
  };
  Weights all(model.layers.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Layer& layer = model.layers[i];
    const Counts count = counts_of(layer);
    if (count.filters == 0) continue;
    LayerWeights& w = all[i];
    const auto fan_in = static_cast<float>(count.weights / count.filters);
    const float gain = layer.activation == Activation::linear ? 1.0F : 1.4F;
    for (std::size_t k = 0; k < count.weights; ++k) {
      w.weights.push_back(normal() * gain / std::sqrt(fan_in));
    }
    for (std::size_t c = 0; c < count.filters; ++c) {
      w.biases.push_back(0.1F * normal());
      if (!count.batch_normalize) continue;
      w.scales.push_back(0.8F + 0.4F * uniform());
      w.means.push_back(0.1F * normal());
      w.variances.push_back(0.8F + 0.4F * uniform());
    }
  }
  return all;
}

std::string format_weights(const Weights& weights) {
  const std::int32_t header[5] = {0, 2, 5, 0, 0};
  std::string bytes(reinterpret_cast<const char*>(header), sizeof header);
  for (const LayerWeights& layer : weights) {
    for (const auto* part :
         {&layer.biases, &layer.scales, &layer.means, &layer.variances, &layer.weights}) {
      bytes.append(reinterpret_cast<const char*>(part->data()), part->size() * sizeof(float));
    }
  }
  return bytes;
}

}  // namespace partita::io::darknet
