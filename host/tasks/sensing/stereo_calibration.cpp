#include "host/tasks/sensing/stereo_calibration.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "host/io/text.h"
#include "host/runtime/error.h"
#include "host/tasks/sensing/kitti_calibration.h"

namespace partita::sensing {

namespace {

using io::TextFile;
using io::TextRow;

/// The lines "key=values" of a Middlebury calibration, brackets and semicolons left out.
class Middlebury {
 public:
  explicit Middlebury(const TextFile& file) : file_(file) {
    for (const TextRow& row : file.rows()) {
      const std::string_view first = row.words[0];
      const std::size_t equals = first.find('=');
      if (equals == std::string_view::npos) file.fail(row, "expected 'key=value'");
      TextRow values{row.line, {}};
      for (std::string_view word : row.words) {
        if (word.data() == first.data()) word.remove_prefix(equals + 1);
        const std::size_t begin = word.find_first_not_of("[];");
        if (begin == std::string_view::npos) continue;
        values.words.push_back(word.substr(begin, word.find_last_not_of("[];") + 1 - begin));
      }
      rows_.emplace(first.substr(0, equals), std::move(values));
    }
  }

  bool has(std::string_view key) const { return rows_.contains(key); }
  const TextRow& row(std::string_view key) const {
    const auto found = rows_.find(key);
    if (found != rows_.end()) return found->second;
    throw Error(
        fmt::format("{}: no line '{}=', expected cam0, cam1 and baseline", file_.path(), key));
  }
  double number(std::string_view key) const { return file_.numbers(row(key), 0, 1, "one")[0]; }

  std::vector<double> camera(std::string_view key) const {
    const TextRow& line = row(key);
    std::vector<double> k = file_.numbers(line, 0, 9, "the 9 of a 3x3 camera matrix");
    const bool pinhole = k[1] == 0 && k[3] == 0 && k[6] == 0 && k[7] == 0 && k[8] == 1;
    if (!pinhole || !(k[0] > 0) || !(k[4] > 0)) {
      file_.fail(line, "not a pinhole camera, expected '[fx 0 cx; 0 fy cy; 0 0 1]'");
    }
    return k;
  }

  int size(std::string_view key) const {
    if (!has(key)) return 0;
    const double value = number(key);
    constexpr double kLargest = 1 << 20;
    if (!(value >= 1 && value <= kLargest) || value != std::floor(value)) {
      file_.fail(row(key), "expected a whole number of pixels");
    }
    return static_cast<int>(value);
  }

 private:
  const TextFile& file_;
  std::map<std::string_view, TextRow> rows_;
};

PairCalibration read_middlebury(const TextFile& file) {
  const Middlebury lines(file);
  const std::vector<double> left = lines.camera("cam0");
  const std::vector<double> right = lines.camera("cam1");
  for (const std::size_t i : {0U, 4U, 5U}) {
    if (std::abs(left[i] - right[i]) > 1e-6 * std::abs(left[i])) {
      file.fail(lines.row("cam1"),
                "the two cameras differ in fx, fy or cy, expected a rectified "
                "pair");
    }
  }
  PairCalibration result;
  result.camera = {.fx = left[0],
                   .fy = left[4],
                   .cx = left[2],
                   .cy = left[5],
                   .baseline = lines.number("baseline") / 1000,
                   .width = lines.size("width"),
                   .height = lines.size("height")};
  result.disparity_offset = lines.has("doffs") ? lines.number("doffs") : right[2] - left[2];
  if (!(result.camera.baseline > 1e-6)) {
    file.fail(lines.row("baseline"), "expected a positive number of millimetres");
  }
  return result;
}

}  // namespace

PairCalibration read_stereo_calibration(const std::string& path, int left) {
  const TextFile file(path);
  const auto assigns = [](const TextRow& row) {
    return row.words[0].find('=') != row.words[0].npos;
  };
  if (std::any_of(file.rows().begin(), file.rows().end(), assigns)) return read_middlebury(file);
  return {read_kitti_calibration(path, left)};
}

}  // namespace partita::sensing
