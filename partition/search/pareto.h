// The Pareto front: placements that no other one beats or equals in everything and beats in
// something.
#ifndef PARTITA_PARTITION_SEARCH_PARETO_H
#define PARTITA_PARTITION_SEARCH_PARETO_H

#include <cstddef>
#include <vector>

#include "partition/search/objective.h"

namespace partita::partition {

/// `a` is nowhere worse than `b` and somewhere better, in latency p50 and p99, energy, throughput,
/// area, price, and the share of work dropped (else what leaves out work would push out what does
/// it).
bool dominates(const Score& a, const Score& b);

/// Indices of the scores that none dominates, ascending. Equal scores are all in or all out.
std::vector<std::size_t> pareto_front(const std::vector<Score>& scores);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_PARETO_H
