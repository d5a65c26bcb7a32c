// Actor: where a task is in what it does for one frame after the other. For driver.h, which moves
// it, and repetition.h, which compares. Inside the partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_ACTOR_H
#define PARTITA_PARTITION_SIMULATE_ACTOR_H

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "partition/simulate/compile.h"

namespace partita::partition {

/// When each task did each frame. A frame that a task does not do has no times.
struct Trace {
  static constexpr Ns kNot = std::numeric_limits<Ns>::max();
  struct Task {
    std::vector<Ns> start, end;  ///< by frame: inputs there, outputs posted
    std::vector<Ns> gone;        ///< by frame: when it was dropped
    std::size_t dropped = 0;
  };
  std::vector<Task> tasks;
};

struct Actor {
  enum class State : std::uint8_t { ready, blocked, done };
  enum class Stage : std::uint8_t { take, trigger, sense, inputs, turn, steps };
  State state = State::ready;
  Stage stage = Stage::take;
  std::size_t next = 0;     ///< first frame that has not been looked at yet
  std::size_t frame = 0;    ///< in work
  std::size_t decided = 0;  ///< frames below are posted, or will never be
  std::uint32_t input = 0;
  bool any = false;  ///< an input of this frame has come
  std::size_t op = 0;
  const CompiledFrame* program = nullptr;
  std::vector<std::size_t> queue;  ///< frames that wait; a handful at most

  /// Before the first frame; its queue keeps its memory.
  void reset() {
    std::vector<std::size_t> empty = std::move(queue);
    empty.clear();
    *this = {};
    queue = std::move(empty);
  }
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_ACTOR_H
