// Where the contents of memory are. In a context of several devices a command may use what another
// device has written: it is moved first, over that device's link to the host and over its own one
// to the device, as runtimes do it behind the program's back.
#ifndef PARTITA_DEVICES_LAYER_RESIDENCE_H
#define PARTITA_DEVICES_LAYER_RESIDENCE_H

#include <span>
#include <vector>

#include "devices/layer/state.h"

namespace partita::layer {

/// What a command does with a memory object. A write counts as one of the whole object.
struct MemoryUse {
  cl_mem handle = nullptr;
  bool reads = false, writes = false;
};

/// What a launch does with the buffers and images of its arguments; empty in a context of one
/// device, where nothing moves.
std::vector<MemoryUse> uses_of(const Kernel& kernel, const Queue& queue);

/// The moves that a command of `queue` needs, on the predicted clock; usually none. Afterwards the
/// memory is where the command leaves it. state().mutex is held all its life.
class Moves {
 public:
  Moves(const Queue& queue, timeline::ThreadId thread, std::span<const MemoryUse> uses,
        std::span<const timeline::NodeId> waits);
  ~Moves();
  Moves(const Moves&) = delete;
  Moves& operator=(const Moves&) = delete;

  /// What the command waits for: its own waits, and the moves.
  std::span<const timeline::NodeId> waits() const { return moves_ ? all_ : own_; }

 private:
  void move(Device& from, Device& to, std::uint64_t bytes, timeline::ThreadId thread);
  timeline::NodeId transfer(Device& device, timeline::CommandKind kind, std::uint64_t bytes,
                            std::span<const timeline::NodeId> waits, timeline::ThreadId thread);

  std::span<const timeline::NodeId> own_;
  std::vector<timeline::NodeId> all_;  ///< own_ and one node for each move
  std::size_t moves_ = 0;
};

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_RESIDENCE_H
