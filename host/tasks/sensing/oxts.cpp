#include "host/tasks/sensing/oxts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "host/io/csv.h"
#include "host/io/text.h"
#include "host/runtime/error.h"
#include "host/tasks/sensing/geodesy.h"
#include "host/tasks/sensing/imu_check.h"

namespace partita::sensing {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kIndexNs = 10'000'000;
constexpr double kMostIndex = 1e9;

/// The fields of a row that are used, in the order of KITTI's dataformat.txt.
struct OxtsRow {
  std::int64_t timestamp_ns = 0;
  Geodetic place;
  double roll = 0, pitch = 0, yaw = 0;  ///< rad; yaw: 0 is east, to the left
  double north = 0, east = 0, up = 0;   ///< velocity, m/s
  Eigen::Vector3d accel, gyro;
  std::size_t line = 0;
};

/// lat lon alt roll pitch yaw vn ve vf vl vu ax ay az af al au wx wy wz …
enum : std::size_t {
  kLat,
  kLon,
  kAlt,
  kRoll,
  kPitch,
  kYaw,
  kVn,
  kVe,
  kVf,
  kVl,
  kVu,
  kAx,
  kAf = 14,
  kWx = 17,
  kFields = 20
};

OxtsRow row_of(const double* v) {
  OxtsRow row;
  row.place = {v[kLat], v[kLon], v[kAlt]};
  row.roll = v[kRoll];
  row.pitch = v[kPitch];
  row.yaw = v[kYaw];
  row.north = v[kVn];
  row.east = v[kVe];
  row.up = v[kVu];
  row.accel = {v[kAx], v[kAx + 1], v[kAx + 2]};
  row.gyro = {v[kWx], v[kWx + 1], v[kWx + 2]};
  return row;
}

class OxtsLog {
 public:
  OxtsLog(std::string path, SensorLog& log) : path_(path), log_(log), check_(std::move(path)) {}

  void add(const OxtsRow& row) {
    check_.add({row.timestamp_ns, row.gyro, row.accel}, row.line);
    if (!log_.truth.empty() && row.timestamp_ns <= log_.truth.back().timestamp_ns) return;
    if (log_.truth.empty()) map_.emplace(row.place);
    TimedPose pose;
    pose.timestamp_ns = row.timestamp_ns;
    using Eigen::AngleAxisd, Eigen::Vector3d;
    pose.T_world_imu.linear() =
        (AngleAxisd(row.yaw, Vector3d::UnitZ()) * AngleAxisd(row.pitch, Vector3d::UnitY()) *
         AngleAxisd(row.roll, Vector3d::UnitX()))
            .toRotationMatrix();
    pose.T_world_imu.translation() = map_->to_map(row.place);
    pose.velocity = Vector3d(row.east, row.north, row.up);
    log_.truth.push_back(pose);
  }
  void finish() { log_.imu = check_.finish(log_.notices); }

 private:
  std::string path_;
  SensorLog& log_;
  ImuCheck check_;
  std::optional<LocalMap> map_;
};

void read_sparse(const fs::path& path, std::int64_t start_ns, SensorLog& log) {
  const io::CsvFile csv(path.string());
  static const char* const kNames[kFields] = {"lat", "lon", "alt", "roll", "pitch", "yaw", "vn",
                                              "ve",  "vf",  "vl",  "vu",   "ax",    "ay",  "az",
                                              "af",  "al",  "au",  "wx",   "wy",    "wz"};
  std::size_t columns[kFields];
  for (std::size_t i = 0; i < kFields; ++i) {
    const auto found = csv.find({kNames[i]});
    if (!found) throw Error(fmt::format("{}: no column '{}'", path.string(), kNames[i]));
    columns[i] = *found;
  }
  OxtsLog out(path.string(), log);
  for (std::size_t r = 0; r < csv.rows(); ++r) {
    const auto index = csv.value(r, 0);
    if (!index || !(*index >= 0 && *index < kMostIndex)) {
      csv.fail(r, "expected the row's number, which counts hundredths of a second");
    }
    double v[kFields];
    for (std::size_t i = 0; i < kFields; ++i) {
      const auto value = csv.value(r, columns[i]);
      if (!value) csv.fail(r, fmt::format("no number in column '{}'", kNames[i]));
      v[i] = *value;
    }
    OxtsRow row = row_of(v);
    row.timestamp_ns = start_ns + static_cast<std::int64_t>(*index) * kIndexNs;
    row.line = csv.line(r);
    out.add(row);
  }
  out.finish();
}

void read_folder(const fs::path& folder, SensorLog& log) {
  const auto times = read_kitti_timestamps((folder / "timestamps.txt").string());
  OxtsLog out((folder / "timestamps.txt").string(), log);
  std::size_t absent = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const fs::path path = folder / "data" / fmt::format("{:010}.txt", k);
    if (!fs::exists(path)) {
      ++absent;
      continue;
    }
    const io::TextFile file(path.string());
    if (file.rows().empty() || file.rows()[0].words.size() < kFields) {
      throw Error(fmt::format("{}: expected one line of 30 numbers", path.string()));
    }
    double v[kFields];
    for (std::size_t i = 0; i < kFields; ++i) v[i] = file.number(file.rows()[0], i);
    OxtsRow row = row_of(v);
    row.timestamp_ns = times[k];
    row.line = k + 1;
    out.add(row);
  }
  out.finish();
  if (absent > 0) {
    log.notices.push_back(
        fmt::format("{}: {} of {} rows are not there", folder.string(), absent, times.size()));
  }
}

/// Days since 1970 of a date (Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms").
std::int64_t days_since_1970(std::int64_t year, std::int64_t month, std::int64_t day) {
  year -= month <= 2 ? 1 : 0;
  const std::int64_t era = year / 400, of_era = year - era * 400;
  const std::int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

}  // namespace

std::vector<std::int64_t> read_kitti_timestamps(const std::string& path) {
  const io::TextFile file(path);
  std::vector<std::int64_t> times;
  for (const io::TextRow& row : file.rows()) {
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, seconds = 0, end = 0;
    double fraction = 0;
    const std::string date(row.words[0]);
    const std::string clock(row.words.size() == 2 ? row.words[1] : std::string_view());
    const std::size_t point = std::min(clock.find('.'), clock.size());
    const bool dated = std::sscanf(date.c_str(), "%4d-%2d-%2d%n", &year, &month, &day, &end) == 3 &&
                       static_cast<std::size_t>(end) == date.size();
    end = 0;
    const bool timed = std::sscanf(clock.substr(0, point).c_str(), "%2d:%2d:%2d%n", &hour, &minute,
                                   &seconds, &end) == 3 &&
                       static_cast<std::size_t>(end) == point;
    const std::string digits = clock.substr(point);
    const bool fine = digits.size() <= 10 &&
                      digits.find_first_not_of("0123456789", digits.empty() ? 0 : 1) == digits.npos;
    const bool ranges = year >= 1970 && year < 2200 && month >= 1 && month <= 12 && day >= 1 &&
                        day <= 31 && hour >= 0 && hour < 24 && minute >= 0 && minute < 60 &&
                        seconds >= 0 && seconds < 61;
    if (!dated || !timed || !fine || !ranges) {
      file.fail(row, "no time, expected 'YYYY-MM-DD HH:MM:SS.fraction'");
    }
    if (digits.size() > 1) fraction = std::strtod(("0" + digits).c_str(), nullptr);
    const std::int64_t whole =
        days_since_1970(year, month, day) * 86400 + hour * 3600 + minute * 60 + seconds;
    times.push_back(whole * 1'000'000'000 + std::llround(fraction * 1e9));
    if (times.size() > 1 && times.back() <= times[times.size() - 2]) {
      file.fail(row, "the time does not increase");
    }
  }
  return times;
}

void read_oxts(const std::string& folder, std::int64_t start_ns, SensorLog& log) {
  const fs::path whole = fs::path(folder) / "oxts", sparse = fs::path(folder) / "oxts_sparse.csv";
  if (fs::exists(whole / "timestamps.txt")) {
    read_folder(whole, log);
  } else if (fs::exists(sparse)) {
    read_sparse(sparse, start_ns, log);
  }
}

}  // namespace partita::sensing
