// CSV files whose header line names the columns.
#ifndef PARTITA_HOST_IO_CSV_H
#define PARTITA_HOST_IO_CSV_H

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace partita::io {

/// One column: its name in small letters without what stands in brackets, and that.
struct CsvColumn {
  std::string name;
  std::string unit;  ///< "[m/s]" or "(m/s)" behind the name: m/s; empty where none is given
};

/// The first line is the header; it may begin with '#' or '%'. Cells are separated by commas (or
/// semicolons, where the header has no comma), blanks around them do not count. Empty lines are
/// left out. Throws Error where the file cannot be read or is not text, where the header has no
/// second column, and, with file and line, where a row has more or fewer cells than the header.
class CsvFile {
 public:
  explicit CsvFile(std::string path);
  CsvFile(const CsvFile&) = delete;  // the cells point into the text
  CsvFile& operator=(const CsvFile&) = delete;

  const std::string& path() const { return path_; }
  const std::vector<CsvColumn>& columns() const { return columns_; }
  std::size_t rows() const { return lines_.size(); }
  std::size_t line(std::size_t row) const { return lines_.at(row); }

  /// The first column that bears one of the names.
  std::optional<std::size_t> find(std::initializer_list<std::string_view> names) const;

  std::string_view cell(std::size_t row, std::size_t column) const {
    return cells_.at(row * columns_.size() + column);
  }
  /// A finite number within +-1e19, or nothing for an empty cell, "nan" and "inf" (a reading that
  /// is not there). Throws Error with file, line and column for anything else.
  std::optional<double> value(std::size_t row, std::size_t column) const;
  /// A whole number exactly, where a double would round it (nanoseconds since 1970).
  std::optional<long long> whole(std::size_t row, std::size_t column) const;

  [[noreturn]] void fail(std::size_t row, std::string_view message) const;

 private:
  std::string path_;
  std::string text_;
  std::vector<CsvColumn> columns_;
  std::vector<std::size_t> lines_;
  std::vector<std::string_view> cells_;
};

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_CSV_H
