// The Evaluator that simulates.
#ifndef PARTITA_PARTITION_SEARCH_SIMULATED_H
#define PARTITA_PARTITION_SEARCH_SIMULATED_H

#include <memory>

#include "partition/search/evaluator.h"

namespace partita::partition {

/// `machine`, `pipeline` and `workload` must outlive it. Throws as Simulator does.
std::unique_ptr<Evaluator> simulated(const profile::Machine& machine, const Pipeline& pipeline,
                                     const Workload& workload, SimulatorOptions options = {});

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_SIMULATED_H
