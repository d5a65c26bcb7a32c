#include "host/io/boxes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "host/io/file.h"
#include "host/io/text.h"
#include "host/runtime/error.h"

namespace partita::io {
namespace {

bool is_nan(std::string_view word) {
  return word == "nan" || word == "NaN" || word == "NAN";
}

/// Minus zero, and what rounds to it, prints a sign that equal results need not share.
double hundredths(double value) {
  const double rounded = std::round(value * 100) / 100;
  return rounded == 0 ? 0.0 : rounded;
}

}  // namespace

std::vector<std::optional<tracking::Box>> read_boxes(const std::string& path) {
  const TextFile file(path, true);
  std::vector<std::optional<tracking::Box>> boxes;
  for (const TextRow& row : file.rows()) {
    if (row.words.size() == 4 && std::all_of(row.words.begin(), row.words.end(), is_nan)) {
      boxes.emplace_back();
      continue;
    }
    const auto v = file.numbers(row, 0, 4, "the 4 of 'x,y,w,h'");
    if (v[2] < 0 || v[3] < 0) file.fail(row, "the box has a negative size");
    boxes.push_back(tracking::Box{v[0], v[1], v[2], v[3]});
  }
  if (boxes.empty()) throw Error(fmt::format("{}: no boxes, expected lines of 'x,y,w,h'", path));
  return boxes;
}

void write_boxes(const std::string& path, const std::vector<std::optional<tracking::Box>>& boxes) {
  std::string text;
  for (const auto& box : boxes) {
    if (!box) {
      text += "nan,nan,nan,nan\n";
      continue;
    }
    fmt::format_to(std::back_inserter(text), "{:.2f},{:.2f},{:.2f},{:.2f}\n", hundredths(box->x),
                   hundredths(box->y), hundredths(box->width), hundredths(box->height));
  }
  write_file(path, text);
}

void write_mot(const std::string& path, const std::vector<MotRow>& rows) {
  std::string text;
  for (const MotRow& row : rows) {
    fmt::format_to(std::back_inserter(text), "{},{},{:.2f},{:.2f},{:.2f},{:.2f},{:.4f},-1,-1,-1\n",
                   row.frame + 1, row.id, hundredths(row.box.x), hundredths(row.box.y),
                   hundredths(row.box.width), hundredths(row.box.height), row.confidence);
  }
  write_file(path, text);
}

}  // namespace partita::io
