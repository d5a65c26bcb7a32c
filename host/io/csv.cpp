#include "host/io/csv.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "host/io/file.h"
#include "host/runtime/error.h"

namespace partita::io {
namespace {

constexpr double kLargest = 1e19;
constexpr std::size_t kMostColumns = 1000;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string small(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// As it may stand in a message: no control characters, not endless.
std::string quoted(std::string_view word) {
  std::string out;
  for (const char c : word.substr(0, 24)) out += (c >= 0x20 && c < 0x7f) ? c : '?';
  return "'" + out + (word.size() > 24 ? "...'" : "'");
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (std::size_t at = 0;;) {
    const std::size_t end = std::min(line.find(separator, at), line.size());
    cells.push_back(trimmed(line.substr(at, end - at)));
    if (end == line.size()) return cells;
    at = end + 1;
  }
}

CsvColumn column_of(std::string_view cell) {
  const std::size_t bracket = cell.find_first_of("[(");
  CsvColumn column{small(trimmed(cell.substr(0, bracket))), {}};
  if (bracket != cell.npos) {
    const std::size_t end = std::min(cell.find_first_of("])", bracket), cell.size());
    column.unit = small(trimmed(cell.substr(bracket + 1, end - bracket - 1)));
  }
  return column;
}

/// nan, NaN, inf, -inf …: what a logger writes where it has no reading.
bool is_no_number(std::string_view cell) {
  std::string word = small(cell);
  if (!word.empty() && (word[0] == '-' || word[0] == '+')) word.erase(0, 1);
  return word == "nan" || word == "inf" || word == "infinity" || word == "null" || word == "na";
}

}  // namespace

CsvFile::CsvFile(std::string path) : path_(std::move(path)), text_(read_file(path_)) {
  if (text_.find('\0') != text_.npos) throw Error(fmt::format("{}: not a text file", path_));
  std::size_t number = 0;
  char separator = ',';
  for (std::size_t at = 0; at < text_.size();) {
    const std::size_t end = std::min(text_.find('\n', at), text_.size());
    std::string_view line = trimmed(std::string_view(text_).substr(at, end - at));
    at = end + 1;
    ++number;
    if (line.empty()) continue;
    if (columns_.empty()) {
      while (!line.empty() && (line[0] == '#' || line[0] == '%')) line = trimmed(line.substr(1));
      if (line.find(',') == line.npos) separator = ';';
      for (const std::string_view cell : cells_of(line, separator)) {
        columns_.push_back(column_of(cell));
      }
      if (columns_.size() < 2 || columns_.size() > kMostColumns) {
        throw Error(fmt::format("{}:{}: {} columns, expected a header line that names 2 to {}",
                                path_, number, columns_.size(), kMostColumns));
      }
      continue;
    }
    if (line[0] == '#' || line[0] == '%') continue;
    const std::vector<std::string_view> cells = cells_of(line, separator);
    if (cells.size() != columns_.size()) {
      throw Error(fmt::format("{}:{}: {} columns, expected {} as in the header", path_, number,
                              cells.size(), columns_.size()));
    }
    lines_.push_back(number);
    cells_.insert(cells_.end(), cells.begin(), cells.end());
  }
  if (columns_.empty()) throw Error(fmt::format("{}: empty, expected a header line", path_));
}

std::optional<std::size_t> CsvFile::find(std::initializer_list<std::string_view> names) const {
  for (const std::string_view name : names) {
    const auto found = std::find_if(columns_.begin(), columns_.end(),
                                    [name](const CsvColumn& c) { return c.name == name; });
    if (found != columns_.end()) return static_cast<std::size_t>(found - columns_.begin());
  }
  return std::nullopt;
}

std::optional<double> CsvFile::value(std::size_t row, std::size_t column) const {
  std::string_view text = cell(row, column);
  if (text.empty() || is_no_number(text)) return std::nullopt;
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range && end == text.data() + text.size()) {
    value = std::strtod(std::string(text).c_str(), nullptr);  // an underflow is a plain zero
  } else if (error != std::errc() || end != text.data() + text.size()) {
    fail(row,
         fmt::format("{} in column '{}' is not a number", quoted(text), columns_[column].name));
  }
  if (!(std::abs(value) <= kLargest)) {
    fail(row,
         fmt::format("{} in column '{}' is out of range", quoted(text), columns_[column].name));
  }
  return value;
}

std::optional<long long> CsvFile::whole(std::size_t row, std::size_t column) const {
  const std::string_view text = cell(row, column);
  long long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

void CsvFile::fail(std::size_t row, std::string_view message) const {
  throw Error(fmt::format("{}:{}: {}", path_, line(row), message));
}

}  // namespace partita::io
