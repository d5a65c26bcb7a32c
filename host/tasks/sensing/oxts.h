// The inertial navigation unit of KITTI's raw recordings.
#ifndef PARTITA_HOST_TASKS_SENSING_OXTS_H
#define PARTITA_HOST_TASKS_SENSING_OXTS_H

#include <cstdint>
#include <string>
#include <vector>

#include "host/tasks/sensing/sensor_log.h"

namespace partita::sensing {

/// "YYYY-MM-DD HH:MM:SS.fraction" (UTC) of each line as nanoseconds since 1970. Throws Error with
/// file and line; the times increase.
std::vector<std::int64_t> read_kitti_timestamps(const std::string& path);

/// Adds readings (the unit's axes: x forward, y left, z up) and poses (as the truth, east-north-up
/// of the first one) from `folder`: oxts/data/*.txt with oxts/timestamps.txt, or oxts_sparse.csv,
/// whose first column counts hundredths of a second from `start_ns`. Nothing where neither is
/// there.
void read_oxts(const std::string& folder, std::int64_t start_ns, SensorLog& log);

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_OXTS_H
