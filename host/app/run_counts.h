// RunCounts: what each frame of a run had to do, as integers: work.json. The same counts give the
// same Work, so the run's jitter can be replayed on other placements without executing anything.
#ifndef PARTITA_HOST_APP_RUN_COUNTS_H
#define PARTITA_HOST_APP_RUN_COUNTS_H

#include <cstdint>
#include <string>
#include <vector>

#include "host/tasks/depth/counts.h"
#include "host/tasks/frontend/counts.h"

namespace partita::app {

struct FrameWork {
  std::int64_t frame = 0;
  frontend::FrameCounts frontend;
  depth::FrameCounts depth;
  bool operator==(const FrameWork&) const = default;
};

struct RunCounts {
  std::string origin;             ///< "30 frames of scenario (seed 1)"
  int width = 0, height = 0;      ///< of the pictures
  std::vector<FrameWork> frames;  ///< that both branches did, in ascending order
  bool operator==(const RunCounts&) const = default;
};

inline constexpr const char* kWorkFile = "work.json";

void write_counts(const std::string& path, const RunCounts& counts);
/// Throws Error for anything but what write_counts() writes: names the file, the frame and the
/// count.
RunCounts read_counts(const std::string& path);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_RUN_COUNTS_H
