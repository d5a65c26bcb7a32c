// Networks in Darknet's format: the layers in a .cfg, their numbers in a .weights file.
#ifndef PARTITA_HOST_IO_DARKNET_H
#define PARTITA_HOST_IO_DARKNET_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace partita::io::darknet {

enum class LayerKind { convolutional, maxpool, upsample, route, shortcut, dropout, yolo };
enum class Activation { linear, leaky, relu, relu6, logistic, swish, mish };
std::string_view to_string(LayerKind kind);
std::string_view to_string(Activation activation);

struct Extent {
  int width = 0, height = 0, channels = 0;
  std::size_t count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
           static_cast<std::size_t>(channels);
  }
  bool operator==(const Extent&) const = default;
};

/// What a [yolo] section says about decoding; training's options are checked and left out.
struct Yolo {
  struct Anchor {
    float width = 0, height = 0;  ///< px of the network's input
  };
  std::vector<Anchor> anchors;  ///< of all scales
  std::vector<int> mask;        ///< those of this scale, in the order of its channels
  int classes = 0;
  float scale_x_y = 1;
};

/// The picture, where a layer's input is meant.
inline constexpr int kPicture = -1;

struct Layer {
  LayerKind kind = LayerKind::convolutional;
  std::size_t line = 0;  ///< of the section in the .cfg
  std::vector<int>
      inputs;      ///< layers that it reads, or kPicture; a shortcut's own predecessor first
  Extent in, out;  ///< `in` of the first input
  int size = 1, stride = 1, pad = 0;  ///< convolutional; maxpool: `pad` before plus after
  int groups = 1;                     ///< convolutional, route
  int group_id = 0;                   ///< route
  bool batch_normalize = false;
  Activation activation = Activation::linear;  ///< convolutional, shortcut
  Yolo yolo;
};

struct Model {
  std::string path;
  Extent input;
  std::vector<Layer> layers;
};

/// Reads the layers and works out their shapes; with `side`, for pictures of that size instead of
/// the width and height in [net]. Throws Error with file and line for what is not understood or
/// does not fit.
Model read_cfg(const std::string& path, std::optional<int> side = {});
Model parse_cfg(std::string_view text, const std::string& path, std::optional<int> side = {});

/// Numbers of a convolutional layer, as in the file. `weights` is [out][in / groups][ky][kx].
struct LayerWeights {
  std::vector<float> biases;
  std::vector<float> scales, means, variances;  ///< empty without batch normalisation
  std::vector<float> weights;
};

/// One entry for each layer; empty for those without numbers.
using Weights = std::vector<LayerWeights>;

/// Throws Error with the layer for a file that is too short or too long for the network, and for
/// what is not a finite number.
Weights read_weights(const std::string& path, const Model& model);
Weights parse_weights(std::string_view bytes, const std::string& path, const Model& model);

/// Seeded numbers under which each layer's results keep the variance of its inputs.
Weights random_weights(const Model& model, std::uint32_t seed);

/// The bytes of a .weights file.
std::string format_weights(const Weights& weights);

}  // namespace partita::io::darknet

#endif  // PARTITA_HOST_IO_DARKNET_H
