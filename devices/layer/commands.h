// Commands for the timeline, by what they do.
#ifndef PARTITA_DEVICES_LAYER_COMMANDS_H
#define PARTITA_DEVICES_LAYER_COMMANDS_H

#include "devices/layer/enqueue.h"

namespace partita::layer {

/// `bytes` over the device's link (read, write, map, unmap).
inline timeline::Command moved(timeline::CommandKind kind, std::uint64_t bytes) {
  timeline::Command command;
  command.kind = kind;
  command.bytes = bytes;
  return command;
}

/// A copy or a fill of `bytes` inside the memory of the queue's device.
timeline::Command inside(cl_command_queue queue, timeline::CommandKind kind, std::uint64_t bytes);

/// A command that only waits (marker, barrier).
inline timeline::Command waiting_only(timeline::CommandKind kind) {
  return moved(kind, 0);
}

/// Bytes of a rectangular region of a buffer; 0 without a region, which the driver refuses.
inline std::uint64_t volume(const std::size_t* region) {
  return region ? std::uint64_t{region[0]} * region[1] * region[2] : 0;
}

/// Bytes of a region of an image.
std::uint64_t image_bytes(cl_mem image, const std::size_t* region);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_COMMANDS_H
