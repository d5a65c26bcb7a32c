// Where a feature map lies in a buffer of floats, as the kernels take it
// (kernels/detection/tensor.clh).
#ifndef PARTITA_HOST_TASKS_DETECTION_TENSOR_H
#define PARTITA_HOST_TASKS_DETECTION_TENSOR_H

#include <cstddef>
#include <cstdint>

namespace partita::detection {

struct TensorView {
  std::int32_t offset = 0;  ///< of pixel (0, 0)'s first channel
  std::int32_t row = 0, pixel = 0;

  std::size_t at(int x, int y, int channel) const {
    return static_cast<std::size_t>(offset + y * row + x * pixel + channel);
  }
};

/// `channels` channels of each pixel, of which a view may take some, with a border around.
struct TensorLayout {
  int width = 0, height = 0, channels = 0, border = 0;

  TensorView view(int first_channel) const {
    const std::int32_t row = (width + 2 * border) * channels;
    return {border * (row + channels) + first_channel, row, channels};
  }
  std::size_t count() const {
    return static_cast<std::size_t>(width + 2 * border) *
           static_cast<std::size_t>(height + 2 * border) * static_cast<std::size_t>(channels);
  }
};

/// Size of the work of a convolution: `width`, `height` and `outputs` of the result.
struct ConvolutionSize {
  int width = 0, height = 0, inputs = 0, outputs = 0, size = 1, stride = 1;
  int border = 0;  ///< of the result
};

/// Linear, leaky and relu: x > 0 ? x : slope * x. Otherwise `code` says which curve.
struct ActivationCode {
  float slope = 1;
  std::int32_t code = 0;  ///< io::darknet::Activation
};

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_TENSOR_H
