#include <algorithm>

#include "partition/search/strategies.h"

namespace partita::partition {

void enumerate(Explored& explored) {
  // Enough for all threads, and few enough for progress to be seen.
  constexpr std::uint64_t kBatch = 256;
  const std::uint64_t all = count(explored.choices());
  for (std::uint64_t first = 0; first < all && !explored.stopped(); first += kBatch) {
    std::vector<TaskPlacement> batch;
    for (std::uint64_t i = first; i < std::min(all, first + kBatch); ++i) {
      batch.push_back(nth(explored.choices(), i));
    }
    explored.look_at(batch);
  }
}

}  // namespace partita::partition
