// The three ways to search. Inside the partition library only.
#ifndef PARTITA_PARTITION_SEARCH_STRATEGIES_H
#define PARTITA_PARTITION_SEARCH_STRATEGIES_H

#include "partition/search/explored.h"

namespace partita::partition {

/// Looks at all placements, in order.
void enumerate(Explored& explored);

/// From greedy placements downhill, moving one task or two at a time; then from changed copies of
/// the best, drawn from a fixed seed, until several in a row bring nothing or `evaluations` are
/// spent.
void local_search(Explored& explored, std::uint64_t evaluations);

/// Looks at what may still be better than the best. Returns the bound, as a cost(), that no
/// placement left out is below: infinite if none was left out.
double branch_and_bound(Explored& explored, std::uint64_t bounds);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_STRATEGIES_H
