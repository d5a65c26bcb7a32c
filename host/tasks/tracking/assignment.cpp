#include "host/tasks/tracking/assignment.h"

#include <limits>

namespace partita::tracking {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One row after the other is brought in along the cheapest alternating path. Rows and columns
/// count from 1 here; column 0 is where a path starts, row 0 is nobody. Needs rows <= columns.
class Assigner {
 public:
  Assigner(std::span<const double> costs, std::size_t rows, std::size_t columns, bool transposed)
      : costs_(costs),
        rows_(rows),
        columns_(columns),
        transposed_(transposed),
        row_potential_(rows + 1),
        column_potential_(columns + 1),
        row_of_(columns + 1) {}

  /// The row of each column, 0 for none.
  std::vector<std::size_t> solve() {
    for (std::size_t row = 1; row <= rows_; ++row) bring_in(row);
    return row_of_;
  }

 private:
  double cost(std::size_t row, std::size_t column) const {
    return transposed_ ? costs_[(column - 1) * rows_ + row - 1]
                       : costs_[(row - 1) * columns_ + column - 1];
  }

  void bring_in(std::size_t row) {
    std::vector<double> least(columns_ + 1, kInfinity);
    std::vector<std::size_t> before(columns_ + 1);
    std::vector<bool> reached(columns_ + 1);
    row_of_[0] = row;
    std::size_t at = 0;
    while (row_of_[at] != 0) {
      reached[at] = true;
      std::size_t next = 0;
      double step = kInfinity;
      for (std::size_t column = 1; column <= columns_; ++column) {
        if (reached[column]) continue;
        const double reduced =
            cost(row_of_[at], column) - row_potential_[row_of_[at]] - column_potential_[column];
        if (reduced < least[column]) {
          least[column] = reduced;
          before[column] = at;
        }
        if (least[column] < step) {
          step = least[column];
          next = column;
        }
      }
      for (std::size_t column = 0; column <= columns_; ++column) {
        if (reached[column]) {
          row_potential_[row_of_[column]] += step;
          column_potential_[column] -= step;
        } else {
          least[column] -= step;
        }
      }
      at = next;
    }
    for (; at != 0; at = before[at]) row_of_[at] = row_of_[before[at]];
  }

  std::span<const double> costs_;
  std::size_t rows_, columns_;
  bool transposed_;
  std::vector<double> row_potential_, column_potential_;
  std::vector<std::size_t> row_of_;
};

}  // namespace

std::vector<std::optional<std::size_t>> assign(std::span<const double> costs, std::size_t rows,
                                               std::size_t columns) {
  std::vector<std::optional<std::size_t>> column_of(rows);
  if (rows == 0 || columns == 0) return column_of;
  const bool transposed = rows > columns;
  Assigner assigner(costs, transposed ? columns : rows, transposed ? rows : columns, transposed);
  const std::vector<std::size_t> other = assigner.solve();
  for (std::size_t k = 1; k < other.size(); ++k) {
    if (other[k] == 0) continue;
    if (transposed) {
      column_of[k - 1] = other[k] - 1;
    } else {
      column_of[other[k] - 1] = k - 1;
    }
  }
  return column_of;
}

}  // namespace partita::tracking
