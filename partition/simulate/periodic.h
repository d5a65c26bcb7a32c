// Frames that each begin on an idle machine, because the one before is over when they are
// triggered: only as many have to be simulated as there are different ones. Tasks that run on every
// k-th frame, and the frames of a recorded run, repeat with the pipeline's cycle, the least common
// multiple of all these numbers. Where frames overlap, repetition.h leaves out cycles instead.
// Inside the partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_PERIODIC_H
#define PARTITA_PARTITION_SIMULATE_PERIODIC_H

#include <optional>
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
/// Nothing if a frame reaches into the next, or hardly any are alike. `clock` and `trace` are
/// scratch.
std::optional<PeriodicRun> run_periodic(const Scene& scene, const Cycle& cycle,
                                        RecallingClock& clock, Trace& trace);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_PERIODIC_H
