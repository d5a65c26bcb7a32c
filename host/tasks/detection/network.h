// YOLOv3's layers, as its public network description (yolov3.cfg) has them.
#ifndef PARTITA_HOST_TASKS_DETECTION_NETWORK_H
#define PARTITA_HOST_TASKS_DETECTION_NETWORK_H

#include <cstdint>
#include <vector>

namespace partita::detection {

inline constexpr std::int64_t kNetworkSide = 416;
inline constexpr std::int64_t kClasses = 80;
inline constexpr std::int64_t kAnchors = 3;  ///< boxes of a cell at each of three scales
inline constexpr std::int64_t kBoxEntries = 5 + kClasses;

enum class LayerKind { convolution, upsample, decode };

/// Maps are square; `side` is the output's.
struct Layer {
  LayerKind kind = LayerKind::convolution;
  std::int64_t side = 0;
  std::int64_t inputs = 0, outputs = 0;  ///< channels
  std::int64_t kernel = 1, stride = 1;   ///< convolution
  bool shortcut = false;                 ///< convolution: an earlier map is added to the result

  /// Multiply-adds of a convolution.
  std::int64_t multiply_adds() const { return side * side * outputs * inputs * kernel * kernel; }
};

/// In the order of execution; 75 of them are convolutions.
std::vector<Layer> yolov3_layers();

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_NETWORK_H
