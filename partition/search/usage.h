// Which parts of a machine a placement uses. Inside the partition library only.
#ifndef PARTITA_PARTITION_SEARCH_USAGE_H
#define PARTITA_PARTITION_SEARCH_USAGE_H

#include <vector>

#include "partition/search/evaluator.h"

namespace partita::partition {

struct Usage {
  std::vector<bool> devices;  ///< those that are not a node's own CPU
  std::vector<bool> nodes;    ///< host threads run there
  std::vector<bool> links;    ///< sensor data or messages cross it
};

Usage usage(const Evaluator& evaluator, const TaskPlacement& placement);

/// As many factors as the machine has parts, all 1.
Speeds as_declared(const profile::Machine& machine);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_USAGE_H
