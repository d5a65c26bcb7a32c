// Which time a row of a drive's CSV belongs to.
//
// A logger stamps rows when it writes them, seconds after they were measured at times; the
// receiver's clock is exact but only ticks with its fixes. Where a file has both, rows are placed
// on the receiver's clock: the unit samples evenly, so that a row's time is the line through the
// ticks around it.
#ifndef PARTITA_HOST_TASKS_SENSING_DRIVE_CLOCK_H
#define PARTITA_HOST_TASKS_SENSING_DRIVE_CLOCK_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/io/csv.h"
#include "host/tasks/sensing/frame.h"

namespace partita::sensing {

struct DriveClockColumns {
  std::optional<std::size_t> logger;    ///< seconds, or ns, us, ms by its name or unit
  std::optional<std::size_t> receiver;  ///< HHMMSSmmm beside a date, or seconds
  bool receiver_is_time_of_day = false;
  bool any() const { return logger || receiver; }
};
DriveClockColumns find_clock_columns(const io::CsvFile& file);

/// Of each row; nothing where it has none. Notices say which clock is used and what was odd.
std::vector<std::optional<std::int64_t>> drive_times(const io::CsvFile& file,
                                                     const DriveClockColumns& columns,
                                                     std::vector<std::string>& notices);

/// To m/s from the unit in which speeds agree best with the positions: m/s, km/h, mph or knots.
/// m/s where nothing moves far enough to tell.
double guess_speed_scale(const std::vector<GpsFix>& fixes);
const char* speed_unit_name(double scale);

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_DRIVE_CLOCK_H
