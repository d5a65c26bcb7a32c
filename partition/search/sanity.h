// The sanity gate of the partitioner: figures that nothing physical can have are refused.
#ifndef PARTITA_PARTITION_SEARCH_SANITY_H
#define PARTITA_PARTITION_SEARCH_SANITY_H

#include "partition/search/bound.h"

namespace partita::partition {

/// Throws profile::Error, one line that names machine, placement and figure: not finite, not above
/// zero, percentiles out of order, a utilisation above 1, more power than all parts draw together,
/// faster than the placement's bounds.
void check_plausible(const Evaluator& evaluator, const TaskPlacement& placement,
                     const Figures& figures, const Bounds& bounds);

/// Which bounds hold for the figures.
inline Drops drops_of(const Figures& figures) {
  return figures.dropped_by_tasks == 0 ? Drops::none : Drops::possible;
}

/// The figures as a Score; checks them first.
Score score_of(const Evaluator& evaluator, const TaskPlacement& placement, const Figures& figures,
               const Bounds& bounds);

/// Share that `used` takes of the resource that it takes most of.
double scarcest_share(const profile::Area& used, const profile::Area& available);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_SANITY_H
