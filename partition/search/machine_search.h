// The search on one machine. Inside the partition library only.
#ifndef PARTITA_PARTITION_SEARCH_MACHINE_SEARCH_H
#define PARTITA_PARTITION_SEARCH_MACHINE_SEARCH_H

#include "partition/search/search.h"

namespace partita::partition {

/// Everything of a MachineResult but its index. Throws profile::Error for pins that the machine
/// cannot satisfy.
MachineResult search_machine(const Evaluator& evaluator, const SearchOptions& options,
                             Comparer& comparer);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_MACHINE_SEARCH_H
