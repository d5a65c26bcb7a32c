#include "host/app/console.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <unistd.h>

#include <fmt/format.h>

#include "host/app/exit_code.h"

namespace partita::app {
namespace {

bool colour_allowed(int descriptor) {
  const char* no_colour = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  return isatty(descriptor) != 0 && (no_colour == nullptr || *no_colour == '\0') &&
         (terminal == nullptr || std::string_view(terminal) != "dumb");
}

const char* code_of(Colour colour) {
  switch (colour) {
    case Colour::red:
      return "\033[31m";
    case Colour::green:
      return "\033[32m";
    case Colour::yellow:
      return "\033[33m";
    case Colour::bold:
      return "\033[1m";
  }
  return "";
}

bool numeric(const std::string& cell) {
  return !cell.empty() && (std::isdigit(static_cast<unsigned char>(cell[0])) != 0 || cell == "-" ||
                           (cell[0] == '-' && cell.size() > 1));
}

/// Printable width: table cells hold ASCII, apart from "µ" and the like.
std::size_t width_of(const std::string& cell) {
  return static_cast<std::size_t>(
      std::count_if(cell.begin(), cell.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

std::string Table::to_string(bool colour) const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], width_of(row[i]));
  }
  // A column is right-aligned if its first cell below the header is a number.
  std::vector<bool> right(widths.size(), false);
  for (std::size_t i = 0; rows_.size() > 1 && i < rows_[1].size(); ++i)
    right[i] = numeric(rows_[1][i]);

  std::string text;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    std::string line;
    for (std::size_t i = 0; i < rows_[r].size(); ++i) {
      const std::string padding(widths[i] - width_of(rows_[r][i]), ' ');
      line += (i == 0 ? "" : "  ") + (right[i] ? padding + rows_[r][i] : rows_[r][i] + padding);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += r == 0 && colour ? fmt::format("\033[1m{}\033[0m\n", line) : line + "\n";
  }
  return text;
}

Console::Console()
    : colour_out_(colour_allowed(STDOUT_FILENO)),
      colour_err_(colour_allowed(STDERR_FILENO)),
      terminal_err_(isatty(STDERR_FILENO) != 0) {}

void Console::result(const std::string& text, const Json& document) const {
  const std::string out = json ? document.dump(2) + "\n" : text;
  // stdout may be a full disk: a truncated result must not look like success.
  if (std::fwrite(out.data(), 1, out.size(), stdout) != out.size() || std::fflush(stdout) != 0) {
    throw OutputError("standard output: cannot be written");
  }
}

void Console::notice(std::string_view line) const {
  if (!quiet) fmt::print(stderr, "partita: {}\n", line);
}

void Console::error(std::string_view line) const {
  fmt::print(stderr, "{}partita: {}{}\n", colour_err_ ? code_of(Colour::red) : "", line,
             colour_err_ ? "\033[0m" : "");
}

std::string Console::paint(Colour colour, std::string_view text) const {
  if (!colour_out_ || json) return std::string(text);
  return fmt::format("{}{}\033[0m", code_of(colour), text);
}

ProgressBar::ProgressBar(const Console& console, std::string what, std::size_t total)
    : shown_(console.progress_wanted()),
      what_(std::move(what)),
      total_(std::max<std::size_t>(total, 1)) {
  update(0);
}

void ProgressBar::update(std::size_t done) {
  if (!shown_) return;
  constexpr std::size_t kWidth = 40;
  const std::size_t filled = kWidth * std::min(done, total_) / total_;
  fmt::print(stderr, "\r{} [{}{}] {}/{}", what_, std::string(filled, '#'),
             std::string(kWidth - filled, '.'), done, total_);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressBar::clear() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
  drawn_ = false;
}

std::string format_ns(double ns) {
  constexpr std::array<const char*, 4> kUnits{"ns", "us", "ms", "s"};
  std::size_t unit = 0;
  while (std::abs(ns) >= 1000 && unit + 1 < kUnits.size()) {
    ns /= 1000;
    ++unit;
  }
  return unit == 0 ? fmt::format("{:.0f} ns", ns) : fmt::format("{:.3f} {}", ns, kUnits[unit]);
}

std::string format_bytes(double bytes) {
  constexpr std::array<const char*, 5> kUnits{"B", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  while (bytes >= 1024 && unit + 1 < kUnits.size()) {
    bytes /= 1024;
    ++unit;
  }
  return fmt::format("{:g} {}", std::round(bytes * 10) / 10, kUnits[unit]);
}

}  // namespace partita::app
