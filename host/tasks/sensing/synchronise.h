// Whether a stereo pair was taken at one moment.
#ifndef PARTITA_HOST_TASKS_SENSING_SYNCHRONISE_H
#define PARTITA_HOST_TASKS_SENSING_SYNCHRONISE_H

#include <cstdint>
#include <string>

namespace partita::sensing {

/// A hardware trigger fires both cameras within microseconds; at 50 km/h a millisecond is already
/// 1.4 cm, which shows as a false disparity on whatever moves across.
inline constexpr std::int64_t kSyncToleranceNs = 1'000'000;

/// Refuses a pair whose times differ by more than the tolerance: throws Error that names the frame
/// and both times.
void check_synchronised(const std::string& frame, std::int64_t left_ns, std::int64_t right_ns,
                        std::int64_t tolerance_ns = kSyncToleranceNs);

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_SYNCHRONISE_H
