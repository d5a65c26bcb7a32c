// Inertial and position readings as CSV files.
//   imu.csv: timestamp_ns,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z   (rad/s, m/s^2)
//   gps.csv: timestamp_ns,east,north,up,sigma                            (metres)
// One header line that begins with '#', then one reading per line in order of time.
#ifndef PARTITA_HOST_TASKS_SENSING_SENSOR_FILES_H
#define PARTITA_HOST_TASKS_SENSING_SENSOR_FILES_H

#include <string>
#include <vector>

#include "host/tasks/sensing/frame.h"

namespace partita::sensing {

void write_imu(const std::string& path, const std::vector<ImuSample>& samples);
void write_gps(const std::string& path, const std::vector<GpsFix>& fixes);

/// Throw Error with file and line for what does not parse or goes back in time.
std::vector<ImuSample> read_imu(const std::string& path);
std::vector<GpsFix> read_gps(const std::string& path);

/// The readings with after < timestamp_ns <= until, of a list in order of time.
template <class Reading>
std::vector<Reading> readings_between(const std::vector<Reading>& all, std::int64_t after,
                                      std::int64_t until) {
  std::vector<Reading> result;
  for (const Reading& r : all) {
    if (r.timestamp_ns > after && r.timestamp_ns <= until) result.push_back(r);
  }
  return result;
}

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_SENSOR_FILES_H
