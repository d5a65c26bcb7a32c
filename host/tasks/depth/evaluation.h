// How good a disparity map is, by the measures that stereo benchmarks print.
//
// A pixel counts if its true disparity is known (and the mask, where there is one, says so); it is
// compared if the map has a disparity there as well. Its error is the absolute difference in
// pixels. Then
//   density      share of the pixels that count which are compared
//   bad-N        share of the compared pixels whose error is above N px
//   mean error   over the compared pixels
// so that what a map leaves out lowers its density and nothing else. Benchmarks that take a missing
// disparity for a wrong one use
//   bad-N or missing   share of the pixels that count whose error is above N px or that have none
#ifndef PARTITA_HOST_TASKS_DEPTH_EVALUATION_H
#define PARTITA_HOST_TASKS_DEPTH_EVALUATION_H

#include <cstdint>

#include "host/tasks/sensing/frame.h"

namespace partita::depth {

/// Sums over the pixels of one map, or of several; percentages are 0 where nothing was counted.
struct Evaluation {
  std::uint64_t with_truth = 0;  ///< pixels that count
  std::uint64_t compared = 0;
  std::uint64_t over_1 = 0;  ///< compared, and more than 1 px off
  std::uint64_t over_3 = 0;
  double error_sum = 0;  ///< px

  Evaluation& operator+=(const Evaluation& other);
  double density() const;  ///< 0..1
  double bad1_percent() const;
  double bad3_percent() const;
  double bad1_or_missing_percent() const;
  double bad3_or_missing_percent() const;
  double mean_error_px() const;
};

/// Disparities in pixels; in both, what is not positive or not finite is "none". `mask` (0: the
/// pixel does not count) may be left out. Throws Error if the sizes differ.
Evaluation evaluate(const sensing::FloatImage& disparity, const sensing::FloatImage& truth,
                    const sensing::GrayImage* mask = nullptr);

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_EVALUATION_H
