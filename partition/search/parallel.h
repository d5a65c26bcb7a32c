// A loop over all cores. Inside the partition library only.
#ifndef PARTITA_PARTITION_SEARCH_PARALLEL_H
#define PARTITA_PARTITION_SEARCH_PARALLEL_H

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace partita::partition {

/// Calls body(i) for each i below `count`, in any order. If some throw, rethrows what the smallest
/// of them threw, so that the error does not depend on the number of threads.
template <typename Body>
void parallel_for(std::size_t count, unsigned threads, const Body& body) {
  std::vector<std::exception_ptr> errors(count);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        body(i);
      } catch (...) {
        errors[i] = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t t = 1; t < std::min<std::size_t>(threads, count); ++t) {
      others.emplace_back(work);
    }
    work();
  }
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_PARALLEL_H
