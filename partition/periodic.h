// Frames that are all alike, exactly and without simulating all of them. Tasks that run on every
// k-th frame repeat with the pipeline's cycle, the least common multiple of all k. Where a frame is
// over before the next one is triggered, every frame begins on an idle machine, and only as many
// have to be simulated as there are different sets of tasks at work; where that holds for a whole
// cycle only, one cycle. Inside the partitioner only.
#ifndef PARTITA_PARTITION_PERIODIC_H
#define PARTITA_PARTITION_PERIODIC_H

#include <optional>

#include "partition/compiled_clock.h"

namespace partita::partition {

/// Frames after which the same tasks run again. Throws profile::Error above 10,000.
std::size_t cycle_of(const Pipeline& pipeline);

/// Sums over `frames` frames, a multiple of the cycle: what figures follow from.
struct PeriodicRun {
  Figures figures;          ///< as figures_of() gives them
  Consumption consumption;
};
/// `scene.frames` is how many frames it is for. Nothing if frames of one cycle reach into the next:
/// then they have to be simulated. `clock` and `trace` are scratch.
std::optional<PeriodicRun> run_periodic(const Scene& scene, CompiledClock& clock, Trace& trace);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_PERIODIC_H
