// Frames that each begin on an idle machine, because the one before is over when they are
// triggered: only as many have to be simulated as there are different ones. Tasks that run on every
// k-th frame, and the frames of a recorded run, repeat with the pipeline's cycle, the least common
// multiple of all these numbers. Where frames overlap, repetition.h leaves out cycles instead.
// Inside the partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_PERIODIC_H
#define PARTITA_PARTITION_SIMULATE_PERIODIC_H

#include <utility>
#include <vector>

#include "partition/simulate/recalling_clock.h"
#include "partition/simulate/repetition.h"

namespace partita::partition {

/// Frames on which the same tasks do the same: the first and the last of them, and how many.
struct FrameKind {
  std::size_t first = 0, last = 0, count = 0;
};

/// How the frames of a simulation repeat, on any placement.
struct Cycle {
  std::size_t length = 0;  ///< frames; 0: longer than the simulation
  std::vector<FrameKind> kinds;
};
/// `works`: by task of the pipeline.
Cycle cycle_of(const Pipeline& pipeline, const std::vector<const TaskWork*>& works,
               std::size_t frames);

struct PeriodicRun {
  Figures figures;  ///< as figures_of() gives them, of all the scene's frames
  Consumption consumption;
};
/// Values with how often each occurs; the same figures as distribution() of all of them.
class Weighted {
 public:
  void clear() { values_.clear(); }
  void add(Ns value, std::size_t count) { values_.push_back({value, count}); }
  Distribution distribution();

 private:
  std::vector<std::pair<Ns, std::size_t>> values_;
};

/// Runs one placement after the other.
class Periodic {
 public:
  /// `clock` and `trace` are scratch. All must outlive it.
  Periodic(const Pipeline& pipeline, RecallingClock& clock, Trace& trace)
      : clock_(clock),
        trace_(trace),
        frame_{.pipeline = &pipeline},
        driver_(frame_, clock, trace) {}

  /// Nothing if a frame reaches into the next, or hardly any are alike. Until the next call.
  const PeriodicRun* run(const Scene& scene, const Cycle& cycle);

 private:
  void clear();
  bool add(const FrameKind& kind);
  void finish();

  RecallingClock& clock_;
  Trace& trace_;
  Scene frame_;  ///< of a single frame
  Driver<RecallingClock> driver_;
  PeriodicRun run_;
  Weighted latency_, perception_;
  std::size_t finished_ = 0;
  Ns first_ = Trace::kNot;  ///< END of the first frame that was finished
  Ns last_ = 0;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_PERIODIC_H
