#include "host/tasks/sensing/kitti_calibration.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "host/io/file.h"
#include "host/io/text.h"
#include "host/runtime/error.h"

namespace partita::sensing {

namespace {

constexpr const char* kTwelve = "the 12 of a 3x4 projection matrix";

/// One camera's matrix, row by row, and the line that holds it.
struct Projection {
  const io::TextRow* row = nullptr;
  std::vector<double> p;
};

bool is_name(std::string_view word) {
  return word.back() == ':';
}

Projection find(const io::TextFile& file, int camera, int left) {
  const std::string name = fmt::format("P{}:", camera);
  const bool named = !file.rows().empty() && is_name(file.rows()[0].words[0]);
  if (!named) {
    const auto index = static_cast<std::size_t>(camera - left);
    if (index >= file.rows().size()) {
      throw Error(fmt::format("{}: {} lines of numbers, expected two projection matrices",
                              file.path(), file.rows().size()));
    }
    const io::TextRow& row = file.rows()[index];
    return {&row, file.numbers(row, 0, 12, kTwelve)};
  }
  const std::string raw_name = fmt::format("P_rect_{:02}:", camera);
  for (const io::TextRow& row : file.rows()) {
    if (row.words[0] != name && row.words[0] != raw_name) continue;
    return {&row, file.numbers(row, 1, 12, kTwelve)};
  }
  throw Error(fmt::format("{}: no line '{}', expected the projection matrices of cameras {} and {}",
                          file.path(), name, left, left + 1));
}

void check_projection(const io::TextFile& file, const Projection& camera) {
  const std::vector<double>& p = camera.p;
  const bool pinhole = p[1] == 0 && p[4] == 0 && p[8] == 0 && p[9] == 0 && p[10] == 1;
  if (!pinhole || !(p[0] > 0) || !(p[5] > 0)) {
    file.fail(*camera.row, "not a pinhole projection, expected 'fx 0 cx tx 0 fy cy ty 0 0 1 tz'");
  }
}

}  // namespace

StereoCalibration read_kitti_calibration(const std::string& path, int left) {
  const io::TextFile file(path);
  const Projection l = find(file, left, left);
  const Projection r = find(file, left + 1, left);
  check_projection(file, l);
  check_projection(file, r);
  for (const std::size_t i : {0U, 2U, 5U, 6U}) {
    if (std::abs(l.p[i] - r.p[i]) > 1e-6 * std::abs(l.p[i])) {
      file.fail(*r.row, "the two cameras differ in fx, fy, cx or cy, expected a rectified pair");
    }
  }
  StereoCalibration result;
  result.fx = l.p[0];
  result.fy = l.p[5];
  result.cx = l.p[2];
  result.cy = l.p[6];
  result.baseline = (l.p[3] - r.p[3]) / l.p[0];
  if (!(result.baseline > 1e-6) || !std::isfinite(result.baseline)) {
    file.fail(*r.row, fmt::format("a baseline of {:g} m, expected the right camera at +x",
                                  result.baseline));
  }
  return result;
}

void write_kitti_calibration(const std::string& path, const StereoCalibration& c) {
  const auto row = [&c](const char* name, double shift) {
    return fmt::format("{}: {} 0 {} {} 0 {} {} 0 0 0 1 0\n", name, c.fx, c.cx, shift, c.fy, c.cy);
  };
  io::write_file(path, row("P0", 0.0) + row("P1", -c.fx * c.baseline));
}

}  // namespace partita::sensing
