// Golden references of the detection kernels: plain C++, one number at a time. The kernels of all
// variants must give exactly these numbers: a sum is one chain of std::fma in the order given.
#ifndef PARTITA_HOST_TASKS_DETECTION_GOLDEN_H
#define PARTITA_HOST_TASKS_DETECTION_GOLDEN_H

#include <cstdint>
#include <span>

#include "host/tasks/detection/tensor.h"

namespace partita::detection {

/// A map to read; `numbers` is the whole buffer.
struct Source {
  std::span<const float> numbers;
  TensorView view;
  float operator()(int x, int y, int channel) const { return numbers[view.at(x, y, channel)]; }
};

struct Target {
  std::span<float> numbers;
  TensorView view;
  float& operator()(int x, int y, int channel) const { return numbers[view.at(x, y, channel)]; }
};

float golden_activation(float x, ActivationCode activation);

/// `in` is the first pixel's window, with what it needs of the border.
/// weights[block][ky][kx][input] [lanes], blocks of `lanes` outputs; bias of as many as the blocks
/// have. The chain starts with the bias and goes by ky, kx, input. A residual of pixel 0 is none.
void golden_convolution(const ConvolutionSize& size, int lanes, const Source& in,
                        std::span<const float> weights, std::span<const float> bias,
                        const Source& residual, ActivationCode activation, const Target& out);

/// inputs == outputs; weights[ky][kx][channel].
void golden_depthwise(const ConvolutionSize& size, const Source& in, std::span<const float> weights,
                      std::span<const float> bias, const Source& residual,
                      ActivationCode activation, const Target& out);

struct PoolSize {
  int in_width = 0, in_height = 0, width = 0, height = 0, channels = 0;
  int size = 1, stride = 1, before = 0;  ///< pixels outside, left and above, that windows may cover
  int border = 0;
};
/// The largest number of the window's pixels inside the map; -FLT_MAX if there is none.
void golden_maxpool(const PoolSize& size, const Source& in, const Target& out);

/// Each pixel `stride` times in both directions; width and height of the result.
void golden_upsample(int width, int height, int channels, int stride, int border, const Source& in,
                     const Target& out);

void golden_add(int width, int height, int channels, int border, const Source& a, const Source& b,
                ActivationCode activation, const Target& out);

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_GOLDEN_H
