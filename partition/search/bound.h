// Bounds that no placement can beat, from what each task takes at the very least
// (Evaluator::least). With every task placed they bound that placement; with some of them open,
// every way to place those.
//
//   latency     the larger of the critical path (least durations over the graph, to the outputs)
//   and
//               of the work of one frame that has to share an engine. Where an engine cannot keep
//               up with the cameras and no frame is dropped, frame k waits for the work of k
//               frames.
//   throughput  the cameras' rate; the slowest task, which does one frame after the other; the
//               engine with most work a frame
//   energy      the idle power of the parts in use, and what each task adds
//   price       the parts in use
//
// A task with a bounded queue may drop a frame, and then what reads its output goes on without, if
// it has another input. So there are two kinds: bounds for any placement, in which only tasks count
// that certainly do their part of a frame, and tighter ones for placements under which nothing is
// dropped. Those rank first, so that the tighter ones may be used as soon as one of them is known.
#ifndef PARTITA_PARTITION_SEARCH_BOUND_H
#define PARTITA_PARTITION_SEARCH_BOUND_H

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "partition/search/objective.h"
#include "partition/search/pins.h"

namespace partita::partition {

/// A task without a place yet.
inline constexpr std::uint32_t kOpen = std::numeric_limits<std::uint32_t>::max();

/// Whether tasks with a bounded queue may drop frames.
enum class Drops : std::uint8_t { possible, none };

struct Bounds {
  double path_ns = 0;  ///< critical path
  double load_ns = 0;  ///< most work of a frame on one engine, before the last output
  double p50_ns = 0;   ///< of the latency; >= path_ns and load_ns
  double p99_ns = 0;
  double frame_ns = 0;  ///< per finished frame in the long run: 1e9 / throughput
  double energy_j = 0;  ///< per frame
  double price_usd = 0;
  double makespan_ns = 0;    ///< from the first frame's trigger to the end of everything
  std::size_t finished = 0;  ///< frames that all outputs do, if none is dropped
  /// The objective's bound as a cost().
  double cost(Objective objective) const;
  /// As far as there are bounds; the rest is 0.
  Score score() const;
};

/// Computes bounds of partial placements; built once per search. `evaluator` must outlive it.
class Bounder {
 public:
  Bounder(const Evaluator& evaluator, const Choices& choices, Drops drops);
  ~Bounder();
  Bounder(const Bounder&) = delete;

  /// `placement` may hold kOpen.
  Bounds operator()(const TaskPlacement& placement) const;
  /// Of the whole space.
  Bounds root() const;

 private:
  struct Task;
  void find_required(const std::vector<bool>& certain);
  double path(const TaskPlacement& placement) const;
  void add_loads(const TaskPlacement& placement, Bounds& bounds) const;
  void add_waiting(double longest, Bounds& bounds) const;
  void add_parts(const TaskPlacement& placement, Bounds& bounds) const;

  const Evaluator& evaluator_;
  std::vector<Task> tasks_;
  std::size_t finished_ = 1;
  double period_ns_ = 0;  ///< of the cameras
  double last_trigger_ns_ = 0;
  std::uint32_t stride_ = 1;  ///< every how many-th frame all outputs run on
  bool drops_ = false;        ///< an output may not do all of its frames
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_BOUND_H
