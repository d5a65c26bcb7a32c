#include "host/tasks/sensing/sensor_files.h"

#include <iterator>

#include <fmt/format.h>

#include "host/io/file.h"
#include "host/io/text.h"

namespace partita::sensing {

namespace {

/// Nanoseconds fit a double exactly up to 104 days; larger ones are no times of a drive.
constexpr double kLatest = 9e15;

template <class Reading, class Convert>
std::vector<Reading> read_rows(const std::string& path, std::size_t columns, const char* expected,
                               Convert convert) {
  const io::TextFile file(path, true);
  std::vector<Reading> result;
  for (const io::TextRow& row : file.rows()) {
    const std::vector<double> v = file.numbers(row, 0, columns, expected);
    if (v[0] > kLatest || v[0] < -kLatest) file.fail(row, "the time is out of range");
    Reading reading = convert(v);
    reading.timestamp_ns = static_cast<std::int64_t>(v[0]);
    if (!result.empty() && reading.timestamp_ns <= result.back().timestamp_ns) {
      file.fail(row, "the time does not increase");
    }
    result.push_back(reading);
  }
  return result;
}

}  // namespace

void write_imu(const std::string& path, const std::vector<ImuSample>& samples) {
  std::string text = "#timestamp_ns,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n";
  for (const ImuSample& s : samples) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{}\n", s.timestamp_ns, s.gyro.x(),
                   s.gyro.y(), s.gyro.z(), s.accel.x(), s.accel.y(), s.accel.z());
  }
  io::write_file(path, text);
}

void write_gps(const std::string& path, const std::vector<GpsFix>& fixes) {
  std::string text = "#timestamp_ns,east,north,up,sigma\n";
  for (const GpsFix& f : fixes) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", f.timestamp_ns, f.position.x(),
                   f.position.y(), f.position.z(), f.sigma);
  }
  io::write_file(path, text);
}

std::vector<ImuSample> read_imu(const std::string& path) {
  return read_rows<ImuSample>(path, 7, "the 7 of an inertial reading",
                              [](const std::vector<double>& v) {
                                ImuSample s;
                                s.gyro = {v[1], v[2], v[3]};
                                s.accel = {v[4], v[5], v[6]};
                                return s;
                              });
}

std::vector<GpsFix> read_gps(const std::string& path) {
  return read_rows<GpsFix>(path, 5, "the 5 of a position fix", [](const std::vector<double>& v) {
    GpsFix f;
    f.position = {v[1], v[2], v[3]};
    f.sigma = v[4];
    return f;
  });
}

}  // namespace partita::sensing
