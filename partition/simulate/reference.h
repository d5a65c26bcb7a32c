// The slow and sure way to simulate a placement: on the real Timeline, with a record that replays.
// Inside the partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_REFERENCE_H
#define PARTITA_PARTITION_SIMULATE_REFERENCE_H

#include "partition/simulate/figures.h"

namespace partita::partition {

struct ReferenceRun {
  Trace trace;
  timeline::Record record;
  timeline::Schedule schedule;  ///< replayed
  Ns live_horizon = 0;          ///< the Timeline's own, before any replay
};
ReferenceRun run_reference(const Scene& scene, const Compiler& compiler);

/// The energy of a schedule by timeline::energy(), without what the placement does not need.
double reference_joules(const ReferenceRun& run, const Parts& parts,
                        const profile::Machine& machine);
std::vector<EngineUse> engines_of(const ReferenceRun& run, const profile::Machine& machine);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_REFERENCE_H
