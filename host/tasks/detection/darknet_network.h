// A Darknet network on a device: prepared once, then run picture by picture.
#ifndef PARTITA_HOST_TASKS_DETECTION_DARKNET_NETWORK_H
#define PARTITA_HOST_TASKS_DETECTION_DARKNET_NETWORK_H

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "host/io/darknet.h"
#include "host/runtime/session.h"
#include "host/tasks/detection/plan.h"

namespace partita::detection {

/// One scale's numbers, not decoded yet: what goes into a [yolo] layer.
struct RawOutput {
  std::size_t layer = 0;  ///< the yolo layer in model().layers: anchors, mask, classes
  int width = 0, height = 0, channels = 0;
  /// [y][x][channel]; channels as Darknet orders them: for each anchor of the mask x, y, w, h,
  /// objectness, classes.
  std::vector<float> values;

  const float* cell(int x, int y) const {
    return &values[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)) *
                   static_cast<std::size_t>(channels)];
  }
};

class DarknetNetwork {
 public:
  /// `session` must have been made with detection::kernel_specs() (kernels.h) and outlive this.
  DarknetNetwork(const runtime::Session& session, io::darknet::Model model,
                 const io::darknet::Weights& weights);
  ~DarknetNetwork();
  DarknetNetwork(DarknetNetwork&&) noexcept;
  DarknetNetwork& operator=(DarknetNetwork&&) noexcept;

  const io::darknet::Model& model() const;
  const Plan& plan() const;

  /// `picture`: [y][x][red, green, blue], 0 to 1, of the size of model().input; `frame` labels
  /// what is recorded. The scales come in
  /// the order of their layers; they stay valid until the next call.
  const std::vector<RawOutput>& run(std::span<const float> picture, std::int64_t frame = 0);

  /// Compiles what the device compiles at the first launch.
  void warm_up();

  /// Seconds of each of plan().steps, the quickest of `rounds`, on the numbers that it really has.
  std::vector<double> time_steps(std::span<const float> picture, int rounds);

  /// Device memory: of all activations, which share it, and of weights.
  std::size_t activation_bytes() const;
  std::size_t weight_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_DARKNET_NETWORK_H
