// Bundle Adjustment in the Large: problems as text (https://grail.cs.washington.edu/projects/bal).
//   cameras points observations
//   camera point x y            for every observation; x, y from the picture's centre, y upwards
//   nine numbers a camera       angle-axis and translation of T_cam_world, f, k1, k2
//   three numbers a point
// separated by blanks or line breaks; the camera looks down -z.
#ifndef PARTITA_HOST_IO_BAL_H
#define PARTITA_HOST_IO_BAL_H

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace partita::io {

struct BalObservation {
  int camera = 0, point = 0;
  double x = 0, y = 0;
};

struct BalProblem {
  std::vector<std::array<double, 9>> cameras;
  std::vector<std::array<double, 3>> points;
  std::vector<BalObservation> observations;
  std::vector<std::size_t> lines;  ///< of the observations, when read from a file
};

/// Throws Error with file and line for what is not a finite number, an index out of range, a file
/// that is cut short or goes on behind its end.
BalProblem read_bal(const std::string& path);

/// Every number so that reading gives it back exactly.
void write_bal(const std::string& path, const BalProblem& problem);

/// Observations of points that lie behind (or in the plane of) the camera that sees them, which
/// the model takes without complaint: how many, and which is the first.
struct Behind {
  std::size_t count = 0;
  std::size_t first = 0;  ///< index of an observation
};
Behind find_behind(const BalProblem& problem);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_BAL_H
