// Who belongs to whom, at least total cost: the Hungarian algorithm (Kuhn 1955, Munkres 1957), in
// the form with potentials and shortest augmenting paths, O(rows^2 columns).
#ifndef PARTITA_HOST_TASKS_TRACKING_ASSIGNMENT_H
#define PARTITA_HOST_TASKS_TRACKING_ASSIGNMENT_H

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace partita::tracking {

/// `costs` is a matrix of rows x columns, row by row, of finite values. Every row gets a column, or
/// every column a row, whichever are fewer. Returns each row's column.
std::vector<std::optional<std::size_t>> assign(std::span<const double> costs, std::size_t rows,
                                               std::size_t columns);

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_ASSIGNMENT_H
