// The wall clock of everything measured: CLOCK_MONOTONIC_RAW, which PoCL's events show as well, so
// that host threads and executed commands fit into one trace.
#ifndef PARTITA_HOST_APP_WALL_CLOCK_H
#define PARTITA_HOST_APP_WALL_CLOCK_H

#include <cstdint>
#include <time.h>

namespace partita::app {

/// Nanoseconds.
inline std::uint64_t wall_now() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC_RAW, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000u +
         static_cast<std::uint64_t>(now.tv_nsec);
}

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_WALL_CLOCK_H
