// A Darknet network as launches: which kernel on which maps, and where the maps lie in memory that
// they share. Layers that only name other layers' numbers (route, dropout, yolo) cost nothing: a
// route's inputs are written where it wants them. A shortcut is added by the convolution before it.
#ifndef PARTITA_HOST_TASKS_DETECTION_PLAN_H
#define PARTITA_HOST_TASKS_DETECTION_PLAN_H

#include <cstddef>
#include <optional>
#include <vector>

#include "host/io/darknet.h"
#include "host/runtime/kernel_spec.h"
#include "host/tasks/detection/tensor.h"

namespace partita::detection {

/// Memory of a map, or of several next to each other.
struct PlannedBuffer {
  TensorLayout layout;
  std::size_t first_step = 0, last_step = 0;  ///< that write or read it
  std::size_t slot = 0;                       ///< memory that it shares with others in turn
};

/// Some channels of a buffer.
struct PlannedMap {
  std::size_t buffer = 0;
  int first_channel = 0;
  io::darknet::Extent extent;
};

enum class StepKernel { convolution, depthwise, maxpool, upsample, add };
const runtime::KernelSpec& spec_of(StepKernel kernel);

struct PlannedStep {
  StepKernel kernel = StepKernel::convolution;
  std::size_t layer = 0;  ///< in the model
  int group = 0;          ///< of a convolution with groups, one step each
  PlannedMap in, out;
  std::optional<PlannedMap> other;  ///< residual of a convolution, second input of an addition
  int pad = 0;
  runtime::Shape shape;  ///< as the kernel's spec wants it
};

struct Plan {
  std::vector<PlannedStep> steps;
  std::vector<PlannedBuffer> buffers;  ///< the first is the picture's, in a slot of its own
  std::vector<std::size_t> slots;      ///< numbers that each holds
  /// What goes into each yolo layer, and which layer it is.
  std::vector<std::pair<std::size_t, PlannedMap>> outputs;

  TensorView view(const PlannedMap& map) const {
    return buffers[map.buffer].layout.view(map.first_channel);
  }
  std::size_t slot_numbers() const;  ///< of all slots
  /// Least that any sharing needs: the largest sum of buffers in use at one time.
  std::size_t live_numbers() const;
};

/// Throws Error for a network without a yolo layer.
Plan make_plan(const io::darknet::Model& model);

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_PLAN_H
