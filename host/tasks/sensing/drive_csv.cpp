#include "host/tasks/sensing/drive_csv.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/tasks/sensing/drive_clock.h"
#include "host/tasks/sensing/imu_check.h"

namespace partita::sensing {
namespace {

using io::CsvFile;
using Column = std::optional<std::size_t>;

constexpr double kRadians = 3.14159265358979323846 / 180;
constexpr double kUsualSigma = 3.0;  ///< of a receiver that does not say, metres
constexpr double kLeastSigma = 0.01;
constexpr double kMovingSpeed = 2.0;  ///< in whatever unit: positions that are held are stale

Column find_axis(const CsvFile& file, const char* axis, std::initializer_list<const char*> forms) {
  for (const char* form : forms) {
    const std::string name = fmt::format(fmt::runtime(form), axis);
    if (const Column found = file.find({name})) return found;
  }
  return std::nullopt;
}

struct Columns {
  DriveClockColumns clock;
  Column gyro[3], accel[3];
  Column latitude, longitude, altitude, east, north, up;
  Column speed, course, sigma, fix;

  explicit Columns(const CsvFile& file) : clock(find_clock_columns(file)) {
    static const char* const kTurns[3] = {"rollrate", "pitchrate", "yawrate"};
    static const char* const kAxes[3] = {"x", "y", "z"};
    for (int i = 0; i < 3; ++i) {
      gyro[i] = find_axis(file, kAxes[i],
                          {"gyro_{}", "gyro{}", "w_rs_s_{}", "w{}", "angular_velocity_{}",
                           "angular_velocity.{}", "field.angular_velocity.{}", "gyr_{}"});
      if (!gyro[i]) gyro[i] = file.find({kTurns[i]});
      accel[i] =
          find_axis(file, kAxes[i],
                    {"accel_{}", "a{}", "a_rs_s_{}", "acc_{}", "acc{}", "linear_acceleration_{}",
                     "linear_acceleration.{}", "field.linear_acceleration.{}"});
    }
    latitude = file.find({"latitude", "lat"});
    longitude = file.find({"longitude", "lon", "lng"});
    altitude = file.find({"altitude", "alt", "height"});
    east = file.find({"east", "x", "e"});
    north = file.find({"north", "y", "n"});
    up = file.find({"up", "z", "u"});
    speed = file.find({"speed", "speed_mps", "speed_kmh", "ground_speed"});
    course = file.find({"course", "track", "cog"});
    sigma = file.find({"sigma", "epe", "pos_accuracy", "accuracy", "hacc"});
    fix = file.find({"fix", "fix_type"});
  }
  bool imu() const {
    const auto there = [](const Column& c) { return c.has_value(); };
    return std::all_of(gyro, gyro + 3, there) && std::all_of(accel, accel + 3, there);
  }
  bool geodetic() const { return latitude && longitude; }
  bool gps() const { return geodetic() || (east && north); }
};

std::optional<double> optional_value(const CsvFile& file, std::size_t row, const Column& column) {
  return column ? file.value(row, *column) : std::nullopt;
}

double gyro_scale(const CsvFile& file, std::size_t column) {
  const io::CsvColumn& c = file.columns()[column];
  const bool degrees =
      c.unit.find("deg") != std::string::npos || c.unit.find("°") != std::string::npos;
  return degrees || (c.unit.empty() && c.name.ends_with("rate")) ? kRadians : 1.0;
}

/// From what the header says of the speed's unit to m/s; 0 where it says nothing.
double speed_scale(const CsvFile& file, std::size_t column) {
  const io::CsvColumn& c = file.columns()[column];
  if (c.unit == "km/h" || c.unit == "kmh" || c.name == "speed_kmh") return 1 / 3.6;
  if (c.unit == "m/s" || c.unit == "m s^-1" || c.name == "speed_mps") return 1;
  if (c.unit == "mph") return 0.44704;
  if (c.unit == "kn" || c.unit == "knots") return 0.514444;
  return 0;
}

void read_imu_columns(const CsvFile& file, const Columns& columns,
                      const std::vector<std::optional<std::int64_t>>& times, SensorLog& log) {
  ImuCheck check(file.path());
  double scale[3];
  for (int i = 0; i < 3; ++i) scale[i] = gyro_scale(file, *columns.gyro[i]);
  for (std::size_t row = 0; row < file.rows(); ++row) {
    if (!times[row]) continue;
    ImuSample sample;
    sample.timestamp_ns = *times[row];
    bool whole = true, any = false;
    for (int i = 0; i < 3; ++i) {
      const auto gyro = file.value(row, *columns.gyro[i]);
      const auto accel = file.value(row, *columns.accel[i]);
      whole = whole && gyro && accel;
      any = any || !file.cell(row, *columns.gyro[i]).empty() ||
            !file.cell(row, *columns.accel[i]).empty();
      sample.gyro[i] = gyro.value_or(0) * scale[i];
      sample.accel[i] = accel.value_or(0);
    }
    if (!any) continue;  // a row of the receiver's alone
    if (!whole) {
      check.missing(file.line(row));
    } else {
      check.add(sample, file.line(row));
    }
  }
  log.imu = check.finish(log.notices);
}

/// Receivers hold their last position between fixes: which rows bring a new one.
class FixRows {
 public:
  FixRows(const CsvFile& file, const Columns& columns)
      : file_(file),
        a_(columns.geodetic() ? *columns.latitude : *columns.east),
        b_(columns.geodetic() ? *columns.longitude : *columns.north),
        receiver_time_(columns.clock.receiver),
        combined_(columns.imu()) {}

  /// `speed` is the receiver's, where the row has it.
  bool is_new(std::size_t row, std::optional<double> speed) {
    speed_ = speed.value_or(speed_);
    const std::string_view a = file_.cell(row, a_), b = file_.cell(row, b_);
    const bool moved = a != last_a_ || b != last_b_;
    moved_since_tick_ = moved_since_tick_ || moved;
    bool ticked = !combined_ || moved;
    if (receiver_time_) {
      const std::string_view tick = file_.cell(row, *receiver_time_);
      ticked = tick != last_tick_ && !tick.empty();
      if (ticked) last_tick_ = tick;
    }
    last_a_ = a;
    last_b_ = b;
    if (!ticked) return false;
    const bool stale = combined_ && !moved_since_tick_ && speed_ > kMovingSpeed;
    moved_since_tick_ = false;
    return !stale;
  }

 private:
  const CsvFile& file_;
  std::size_t a_, b_;
  Column receiver_time_;
  bool combined_;
  bool moved_since_tick_ = false;
  double speed_ = 0;
  std::string_view last_a_, last_b_, last_tick_;
};

std::optional<Eigen::Vector3d> position_at(const CsvFile& file, std::size_t row,
                                           const Columns& columns,
                                           std::optional<LocalMap>& origin) {
  if (!columns.geodetic()) {
    const auto east = file.value(row, *columns.east), north = file.value(row, *columns.north);
    if (!east || !north) return std::nullopt;
    return Eigen::Vector3d(*east, *north, optional_value(file, row, columns.up).value_or(0));
  }
  const auto latitude = file.value(row, *columns.latitude);
  const auto longitude = file.value(row, *columns.longitude);
  if (!latitude || !longitude || (*latitude == 0 && *longitude == 0)) return std::nullopt;
  if (std::abs(*latitude) > 90 || std::abs(*longitude) > 360) {
    file.fail(row,
              fmt::format("latitude {} and longitude {}, expected degrees", *latitude, *longitude));
  }
  const Geodetic place{*latitude, *longitude,
                       optional_value(file, row, columns.altitude).value_or(0)};
  if (!origin) origin.emplace(place);
  return origin->to_map(place);
}

void read_fixes(const CsvFile& file, const Columns& columns,
                const std::vector<std::optional<std::int64_t>>& times, SensorLog& log,
                std::optional<LocalMap>& origin) {
  FixRows fix_rows(file, columns);
  double known_speed_scale = columns.speed ? speed_scale(file, *columns.speed) : 1;
  std::size_t backwards = 0, first_backwards = 0;
  std::vector<GpsFix> fixes;
  for (std::size_t row = 0; row < file.rows(); ++row) {
    const auto speed = optional_value(file, row, columns.speed);
    if (!fix_rows.is_new(row, speed) || !times[row]) continue;
    if (columns.fix && file.value(row, *columns.fix).value_or(0) < 1) continue;
    const auto position = position_at(file, row, columns, origin);
    if (!position) continue;
    GpsFix fix;
    fix.timestamp_ns = *times[row];
    fix.position = *position;
    fix.sigma =
        std::max(kLeastSigma, optional_value(file, row, columns.sigma).value_or(kUsualSigma));
    const auto course = optional_value(file, row, columns.course);
    if (speed && *speed >= 0 && course) {
      fix.speed = *speed;
      fix.course = *course * kRadians;
    }
    fix.line = file.line(row);
    if (!fixes.empty() && fix.timestamp_ns <= fixes.back().timestamp_ns) {
      if (backwards++ == 0) first_backwards = fix.line;
      continue;
    }
    fixes.push_back(fix);
  }
  if (backwards > 0) {
    log.notices.push_back(fmt::format("{}:{}: the time does not increase; {} such fixes left out",
                                      file.path(), first_backwards, backwards));
  }
  if (columns.speed && known_speed_scale == 0) {
    known_speed_scale = guess_speed_scale(fixes);
    log.notices.push_back(fmt::format("{}: no unit of '{}', taken as {} (by the positions)",
                                      file.path(), file.columns()[*columns.speed].name,
                                      speed_unit_name(known_speed_scale)));
  }
  for (GpsFix& fix : fixes) {
    if (fix.speed) *fix.speed *= known_speed_scale;
  }
  log.gps = std::move(fixes);
}

}  // namespace

CsvContents csv_contents(const CsvFile& file) {
  const Columns columns(file);
  return {.time = columns.clock.any(), .imu = columns.imu(), .gps = columns.gps()};
}

void read_drive_csv(const std::string& path, SensorLog& log, std::optional<LocalMap>& origin) {
  const CsvFile file(path);
  const Columns columns(file);
  if (!columns.clock.any()) {
    throw Error(fmt::format("{}: no column of time, expected timestamp_ns, millis, time …", path));
  }
  if (!columns.imu() && !columns.gps()) {
    throw Error(
        fmt::format("{}: neither inertial readings (gyro_x … accel_z) nor positions "
                    "(latitude, longitude or east, north) among its columns",
                    path));
  }
  const auto times = drive_times(file, columns.clock, log.notices);
  if (columns.imu()) read_imu_columns(file, columns, times, log);
  if (columns.gps()) read_fixes(file, columns, times, log, origin);
}

}  // namespace partita::sensing
