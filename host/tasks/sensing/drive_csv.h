// A drive as CSV: inertial readings and position fixes in one file or in two. Columns are found by
// their names in the header line, in any order; what else there is is ignored. See
// docs/localization.md for the names, units and conventions.
#ifndef PARTITA_HOST_TASKS_SENSING_DRIVE_CSV_H
#define PARTITA_HOST_TASKS_SENSING_DRIVE_CSV_H

#include <optional>
#include <string>

#include "host/io/csv.h"
#include "host/tasks/sensing/geodesy.h"
#include "host/tasks/sensing/sensor_log.h"

namespace partita::sensing {

/// What a file's header offers.
struct CsvContents {
  bool time = false;
  bool imu = false;  ///< all six
  bool gps = false;  ///< positions
};
CsvContents csv_contents(const io::CsvFile& file);

/// Adds the file's readings to the log. Readings that are missing (empty, nan), that repeat a time
/// or go back in time, and that are saturated are left out and told as a notice; a cell that is no
/// number is an Error with file and line. `origin` is the map's: set by the first fix in degrees.
void read_drive_csv(const std::string& path, SensorLog& log, std::optional<LocalMap>& origin);

/// Turns readings of a unit that is mounted or signed differently into the conventions of SensorLog
/// (specific force: +9.81 upwards at rest; x forward, y left, z up), as far as gravity and the
/// turns of the GPS's course show it. For logs without a calibration only.
void settle_conventions(SensorLog& log);

/// Noise densities of a unit without a data sheet: what neighbouring readings differ by, four times
/// over, as vibration and the unit's errors of scale are not white.
void measure_noise(SensorLog& log);

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_DRIVE_CSV_H
