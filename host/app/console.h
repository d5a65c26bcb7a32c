// What a person or a script sees. Results go to stdout: as text, or with --json as one JSON
// document of the same content. Notices and progress go to stderr. Colour only on a terminal, never
// with NO_COLOR (https://no-color.org).
#ifndef PARTITA_HOST_APP_CONSOLE_H
#define PARTITA_HOST_APP_CONSOLE_H

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace partita::app {

/// Keeps the order in which keys were added: results read top down.
using Json = nlohmann::ordered_json;

/// Text as columns. Cells that look like numbers are right-aligned.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  bool empty() const { return rows_.size() < 2; }
  /// Lines with a final line break each; the header in bold if `colour`.
  std::string to_string(bool colour) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

enum class Colour { red, green, yellow, bold };

class Console {
 public:
  Console();

  bool json = false;   ///< set by --json
  bool quiet = false;  ///< set by --quiet: no notices, no progress

  /// Prints the result: `text` for people, or `document` with --json.
  void result(const std::string& text, const Json& document) const;
  /// One line on stderr that starts with "partita: ".
  void notice(std::string_view line) const;
  void error(std::string_view line) const;

  std::string paint(Colour colour, std::string_view text) const;
  bool colour() const { return colour_out_; }
  bool progress_wanted() const { return terminal_err_ && !quiet; }

 private:
  bool colour_out_ = false;
  bool colour_err_ = false;
  bool terminal_err_ = false;
};

/// A bar on stderr that is drawn over itself; draws nothing where nobody watches.
class ProgressBar {
 public:
  ProgressBar(const Console& console, std::string what, std::size_t total);
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  void update(std::size_t done);
  void clear();

 private:
  bool shown_;
  std::string what_;
  std::size_t total_;
  bool drawn_ = false;
};

/// 1234567 ns as "1.235 ms"; the unit that leaves 1 to 3 digits before the point.
std::string format_ns(double ns);
/// 16384 as "16 KiB".
std::string format_bytes(double bytes);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_CONSOLE_H
