// Text files made of rows of numbers: calibrations, poses, times.
#ifndef PARTITA_HOST_IO_TEXT_H
#define PARTITA_HOST_IO_TEXT_H

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace partita::io {

/// One line of a text file that holds something: its words, and where it stands.
struct TextRow {
  std::size_t line = 0;  ///< counted from 1
  std::vector<std::string_view> words;
};

/// A text file cut into rows of words. Words are separated by blanks and tabs, and by commas, too,
/// in a CSV file. Empty lines and what follows a '#' are left out. Throws Error when the file
/// cannot be read or is not text.
class TextFile {
 public:
  explicit TextFile(std::string path, bool commas = false);
  TextFile(const TextFile&) = delete;  // the words point into the text
  TextFile& operator=(const TextFile&) = delete;

  const std::string& path() const { return path_; }
  const std::vector<TextRow>& rows() const { return rows_; }

  /// A finite number, however written, within +-1e15 so that what is computed from it stays finite;
  /// otherwise an Error with file and line.
  double number(const TextRow& row, std::size_t word) const;

  /// The row's words from `first` on as `count` numbers, `what` being what they are meant to be.
  std::vector<double> numbers(const TextRow& row, std::size_t first, std::size_t count,
                              std::string_view what) const;

  /// Throws Error "FILE:LINE: MESSAGE".
  [[noreturn]] void fail(const TextRow& row, std::string_view message) const;

 private:
  std::string path_;
  std::string text_;
  std::vector<TextRow> rows_;
};

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_TEXT_H
