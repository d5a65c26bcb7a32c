#include "host/tasks/detection/golden.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "host/io/darknet.h"
#include "host/tasks/detection/curves.h"

// Sums and products stay apart, as in the kernels (FP_CONTRACT OFF); see CMakeLists.txt.
namespace partita::detection {
namespace {

using io::darknet::Activation;

float mish(float x) {
  const float e = exp_80(std::clamp(x, -80.0F, 20.0F));
  const float n = e * (e + 2.0F);
  return x * (n * reciprocal(n + 2.0F));
}

void clear_border(int width, int height, int border, int channels, const Target& out) {
  for (int y = -border; y < height + border; ++y) {
    for (int x = -border; x < width + border; ++x) {
      if (x >= 0 && x < width && y >= 0 && y < height) continue;
      for (int c = 0; c < channels; ++c) out(x, y, c) = 0;
    }
  }
}

}  // namespace

float golden_activation(float x, ActivationCode activation) {
  switch (static_cast<Activation>(activation.code)) {
    case Activation::relu6:
      return std::clamp(x, 0.0F, 6.0F);
    case Activation::logistic:
      return logistic(x);
    case Activation::swish:
      return x * logistic(x);
    case Activation::mish:
      return mish(x);
    default:
      return x > 0 ? x : x * activation.slope;
  }
}

void golden_convolution(const ConvolutionSize& s, int lanes, const Source& in,
                        std::span<const float> weights, std::span<const float> bias,
                        const Source& residual, ActivationCode activation, const Target& out) {
  for (int y = 0; y < s.height; ++y) {
    for (int x = 0; x < s.width; ++x) {
      for (int c = 0; c < s.outputs; ++c) {
        float sum = bias[static_cast<std::size_t>(c)];
        std::size_t k = static_cast<std::size_t>(c / lanes) *
                            static_cast<std::size_t>(s.size * s.size * s.inputs * lanes) +
                        static_cast<std::size_t>(c % lanes);
        for (int ky = 0; ky < s.size; ++ky) {
          for (int kx = 0; kx < s.size; ++kx) {
            for (int i = 0; i < s.inputs; ++i, k += static_cast<std::size_t>(lanes)) {
              sum = std::fma(in(x * s.stride + kx, y * s.stride + ky, i), weights[k], sum);
            }
          }
        }
        sum = golden_activation(sum, activation);
        if (residual.view.pixel != 0) sum += residual(x, y, c);
        out(x, y, c) = sum;
      }
    }
  }
  clear_border(s.width, s.height, s.border, s.outputs, out);
}

void golden_depthwise(const ConvolutionSize& s, const Source& in, std::span<const float> weights,
                      std::span<const float> bias, const Source& residual,
                      ActivationCode activation, const Target& out) {
  for (int y = 0; y < s.height; ++y) {
    for (int x = 0; x < s.width; ++x) {
      for (int c = 0; c < s.outputs; ++c) {
        float sum = bias[static_cast<std::size_t>(c)];
        for (int ky = 0; ky < s.size; ++ky) {
          for (int kx = 0; kx < s.size; ++kx) {
            const int k = (ky * s.size + kx) * s.outputs + c;
            sum = std::fma(in(x * s.stride + kx, y * s.stride + ky, c),
                           weights[static_cast<std::size_t>(k)], sum);
          }
        }
        sum = golden_activation(sum, activation);
        if (residual.view.pixel != 0) sum += residual(x, y, c);
        out(x, y, c) = sum;
      }
    }
  }
  clear_border(s.width, s.height, s.border, s.outputs, out);
}

void golden_maxpool(const PoolSize& s, const Source& in, const Target& out) {
  for (int y = 0; y < s.height; ++y) {
    for (int x = 0; x < s.width; ++x) {
      for (int c = 0; c < s.channels; ++c) {
        float most = -FLT_MAX;
        for (int v = y * s.stride - s.before; v < y * s.stride - s.before + s.size; ++v) {
          for (int u = x * s.stride - s.before; u < x * s.stride - s.before + s.size; ++u) {
            if (u < 0 || v < 0 || u >= s.in_width || v >= s.in_height) continue;
            most = std::max(most, in(u, v, c));
          }
        }
        out(x, y, c) = most;
      }
    }
  }
  clear_border(s.width, s.height, s.border, s.channels, out);
}

void golden_upsample(int width, int height, int channels, int stride, int border, const Source& in,
                     const Target& out) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) out(x, y, c) = in(x / stride, y / stride, c);
    }
  }
  clear_border(width, height, border, channels, out);
}

void golden_add(int width, int height, int channels, int border, const Source& a, const Source& b,
                ActivationCode activation, const Target& out) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        out(x, y, c) = golden_activation(a(x, y, c) + b(x, y, c), activation);
      }
    }
  }
  clear_border(width, height, border, channels, out);
}

}  // namespace partita::detection
