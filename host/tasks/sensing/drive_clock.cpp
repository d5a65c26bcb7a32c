#include "host/tasks/sensing/drive_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace partita::sensing {
namespace {

using io::CsvFile;
using Times = std::vector<std::optional<std::int64_t>>;

constexpr double kDay = 86400;
constexpr double kLatest = 9e18;    ///< nanoseconds that fit
constexpr std::size_t kTicks = 25;  ///< on either side of a row that its time is fitted to

/// Nanoseconds per unit of the logger's column: by its name, its unit, or its values' size.
double logger_unit(const CsvFile& file, std::size_t column) {
  const io::CsvColumn& c = file.columns()[column];
  const auto is = [&](std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(),
                       [&](const char* n) { return c.unit == n || c.name.ends_with(n); });
  };
  if (c.unit == "ns" || c.name.ends_with("_ns")) return 1;
  if (c.unit == "us" || c.name.ends_with("_us")) return 1e3;
  if (c.unit == "ms" || c.name.ends_with("_ms") || is({"millis"})) return 1e6;
  if (c.unit == "s" || c.name.ends_with("_s")) return 1e9;
  // No unit: a logger's step is between a millisecond and a second or so.
  std::vector<double> steps;
  for (std::size_t row = 1; row < std::min<std::size_t>(file.rows(), 100); ++row) {
    const auto a = file.value(row - 1, column), b = file.value(row, column);
    if (a && b && *b > *a) steps.push_back(*b - *a);
  }
  if (steps.empty()) return 1e9;
  std::nth_element(steps.begin(), steps.begin() + static_cast<long>(steps.size() / 2), steps.end());
  return steps[steps.size() / 2] > 1e4 ? 1 : 1e9;
}

Times logger_times(const CsvFile& file, std::size_t column) {
  const double unit = logger_unit(file, column);
  Times times(file.rows());
  for (std::size_t row = 0; row < file.rows(); ++row) {
    const auto value = file.value(row, column);
    if (!value) continue;
    if (std::abs(*value * unit) > kLatest) file.fail(row, "the time is out of range");
    const auto whole = unit == 1 ? file.whole(row, column) : std::nullopt;
    times[row] = whole ? *whole : std::llround(*value * unit);
  }
  return times;
}

/// HHMMSSmmm as seconds of the day.
std::optional<double> time_of_day(const CsvFile& file, std::size_t row, std::size_t column) {
  const auto value = file.value(row, column);
  if (!value) return std::nullopt;
  const auto digits = static_cast<long long>(*value);
  const long long hours = digits / 10'000'000, minutes = digits / 100'000 % 100,
                  milliseconds = digits % 100'000;
  if (*value < 0 || hours > 23 || minutes > 59 || milliseconds >= 60'000) {
    file.fail(row, fmt::format("'{}' is no time of day, expected HHMMSSmmm",
                               file.cell(row, column).substr(0, 24)));
  }
  return static_cast<double>(hours * 3600 + minutes * 60) +
         static_cast<double>(milliseconds) * 1e-3;
}

struct Tick {
  double row = 0;
  double seconds = 0;
};

std::vector<Tick> ticks(const CsvFile& file, const DriveClockColumns& columns) {
  std::vector<Tick> result;
  std::string_view last;
  double days = 0;
  for (std::size_t row = 0; row < file.rows(); ++row) {
    const std::string_view cell = file.cell(row, *columns.receiver);
    if (cell.empty() || cell == last) continue;
    const auto seconds = columns.receiver_is_time_of_day ? time_of_day(file, row, *columns.receiver)
                                                         : file.value(row, *columns.receiver);
    if (!seconds) continue;
    // The first row's tick began before the file did.
    const bool begins = !last.empty() || row > 0;
    last = cell;
    double now = *seconds + days;
    if (columns.receiver_is_time_of_day && !result.empty() &&
        now < result.back().seconds - kDay / 2) {
      days += kDay;
      now += kDay;
    }
    if (!result.empty() && now <= result.back().seconds) continue;
    if (begins) result.push_back({static_cast<double>(row), now});
  }
  return result;
}

/// The line through the ticks around a row, at the row.
double fitted(const std::vector<Tick>& ticks, double row) {
  const auto after = std::lower_bound(ticks.begin(), ticks.end(), row,
                                      [](const Tick& t, double r) { return t.row < r; });
  const auto at = static_cast<std::size_t>(after - ticks.begin());
  const std::size_t first = at > kTicks ? at - kTicks : 0;
  const std::size_t last = std::min(ticks.size(), at + kTicks);
  double mean_row = 0, mean_time = 0;
  const auto count = static_cast<double>(last - first);
  for (std::size_t i = first; i < last; ++i) {
    mean_row += ticks[i].row / count;
    mean_time += ticks[i].seconds / count;
  }
  double both = 0, square = 0;
  for (std::size_t i = first; i < last; ++i) {
    both += (ticks[i].row - mean_row) * (ticks[i].seconds - mean_time);
    square += (ticks[i].row - mean_row) * (ticks[i].row - mean_row);
  }
  return mean_time + (square > 0 ? both / square : 0) * (row - mean_row);
}

}  // namespace

DriveClockColumns find_clock_columns(const CsvFile& file) {
  DriveClockColumns columns;
  const auto time = file.find({"time"});
  if (time && file.find({"date"})) {
    columns.receiver = time;
    columns.receiver_is_time_of_day = true;
  } else {
    columns.receiver = file.find({"gps_time", "receiver_time"});
  }
  columns.logger =
      file.find({"timestamp_ns", "timestamp_us", "timestamp_ms", "timestamp_s", "time_ns",
                 "time_us", "time_ms", "time_s", "millis", "timestamp", "t"});
  if (!columns.logger && !columns.receiver_is_time_of_day) columns.logger = time;
  return columns;
}

Times drive_times(const CsvFile& file, const DriveClockColumns& columns,
                  std::vector<std::string>& notices) {
  Times times;
  if (columns.logger) times = logger_times(file, *columns.logger);
  if (!columns.receiver) return times;
  const std::vector<Tick> known = ticks(file, columns);
  if (known.size() < 3) {
    if (columns.logger) return times;
    file.fail(0,
              fmt::format("the receiver's clock ticks {} times, expected 3 or more", known.size()));
  }
  // Whole days between the receiver's time of day and the logger's date.
  double days = 0;
  std::vector<double> lags;
  if (columns.logger) {
    for (const Tick& tick : known) {
      const auto stamp = times[static_cast<std::size_t>(tick.row)];
      if (stamp) lags.push_back(static_cast<double>(*stamp) * 1e-9 - tick.seconds);
    }
    if (!lags.empty() && columns.receiver_is_time_of_day) {
      days = std::round(lags.front() / kDay) * kDay;
      for (double& lag : lags) lag -= days;
    }
  }
  times.assign(file.rows(), std::nullopt);
  std::int64_t last = std::numeric_limits<std::int64_t>::min();
  for (std::size_t row = 0; row < file.rows(); ++row) {
    const double seconds = fitted(known, static_cast<double>(row));
    std::int64_t ns = std::llround(days) * 1'000'000'000 + std::llround(seconds * 1e9);
    if (ns <= last) ns = last + 1'000;  // neighbouring lines differ by a little
    times[row] = last = ns;
  }
  if (!lags.empty()) {
    const auto [least, most] = std::minmax_element(lags.begin(), lags.end());
    notices.push_back(
        fmt::format("{}: rows are placed on the receiver's clock; the logger's "
                    "stamps are off it by {:+.2f} to {:+.2f} s",
                    file.path(), *least, *most));
  }
  return times;
}

double guess_speed_scale(const std::vector<GpsFix>& fixes) {
  double by_speed = 0, by_position = 0;
  for (std::size_t i = 1; i < fixes.size(); ++i) {
    const double seconds =
        static_cast<double>(fixes[i].timestamp_ns - fixes[i - 1].timestamp_ns) * 1e-9;
    if (!fixes[i].speed || seconds > 5) continue;
    by_speed += *fixes[i].speed * seconds;
    by_position += (fixes[i].position - fixes[i - 1].position).head<2>().norm();
  }
  if (!(by_position > 20) || !(by_speed > 0)) return 1;
  const double ratio = std::log(by_position / by_speed);
  double best = 1;
  for (const double scale : {1.0, 1 / 3.6, 0.44704, 0.514444}) {
    if (std::abs(std::log(scale) - ratio) < std::abs(std::log(best) - ratio)) best = scale;
  }
  return best;
}

const char* speed_unit_name(double scale) {
  return scale == 1 ? "m/s" : scale == 1 / 3.6 ? "km/h" : scale == 0.44704 ? "mph" : "knots";
}

}  // namespace partita::sensing
