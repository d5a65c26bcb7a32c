#include "host/io/text.h"

#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "host/io/file.h"
#include "host/runtime/error.h"

namespace partita::io {

namespace {

constexpr double kLargest = 1e15;

/// A word as it may stand in a message: no control characters, not endless.
std::string quoted(std::string_view word) {
  std::string out;
  for (const char c : word.substr(0, 24)) out += (c >= 0x20 && c < 0x7f) ? c : '?';
  return "'" + out + (word.size() > 24 ? "...'" : "'");
}

std::vector<std::string_view> split(std::string_view line, std::string_view separators) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(separators, at)) != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

}  // namespace

TextFile::TextFile(std::string path, bool commas)
    : path_(std::move(path)), text_(read_file(path_)) {
  if (text_.find('\0') != text_.npos) throw Error(fmt::format("{}: not a text file", path_));
  std::size_t line = 0;
  for (std::size_t at = 0; at < text_.size();) {
    const std::size_t end = std::min(text_.find('\n', at), text_.size());
    const std::string_view whole = std::string_view(text_).substr(at, end - at);
    TextRow row{++line, split(whole.substr(0, whole.find('#')), commas ? " \t\r," : " \t\r")};
    if (!row.words.empty()) rows_.push_back(std::move(row));
    at = end + 1;
  }
}

double TextFile::number(const TextRow& row, std::size_t word) const {
  std::string_view text = row.words.at(word);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range && end == text.data() + text.size()) {
    value = std::strtod(std::string(text).c_str(), nullptr);  // an underflow is a plain zero
  } else if (error != std::errc() || end != text.data() + text.size()) {
    fail(row, fmt::format("{} is not a number", quoted(row.words[word])));
  }
  if (!(std::abs(value) <= kLargest)) {
    fail(row, fmt::format("{} where a finite number was expected", quoted(row.words[word])));
  }
  return value;
}

std::vector<double> TextFile::numbers(const TextRow& row, std::size_t first, std::size_t count,
                                      std::string_view what) const {
  const std::size_t found = row.words.size() - std::min(first, row.words.size());
  if (found != count) fail(row, fmt::format("{} numbers, expected {}", found, what));
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = number(row, first + i);
  return values;
}

void TextFile::fail(const TextRow& row, std::string_view message) const {
  throw Error(fmt::format("{}:{}: {}", path_, row.line, message));
}

}  // namespace partita::io
