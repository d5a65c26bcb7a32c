// Inertial readings as they are read: what cannot be used is left out and told.
#ifndef PARTITA_HOST_TASKS_SENSING_IMU_CHECK_H
#define PARTITA_HOST_TASKS_SENSING_IMU_CHECK_H

#include <cstddef>
#include <string>
#include <vector>

#include "host/tasks/sensing/frame.h"

namespace partita::sensing {

/// Left out: readings that are not finite or absurd, whose time repeats or goes back, and those at
/// the end of the sensor's range (the same extreme value three times running). Holes in the
/// time, longer than kHole usual steps, are only told.
class ImuCheck {
 public:
  explicit ImuCheck(std::string path) : path_(std::move(path)) {}

  void add(const ImuSample& sample, std::size_t line);
  void missing(std::size_t line) { note(missing_, line); }
  /// What can be used; adds one notice for each kind of trouble.
  std::vector<ImuSample> finish(std::vector<std::string>& notices);

  static constexpr double kMostGyro = 100;     ///< rad/s; no unit measures more
  static constexpr double kMostAccel = 2000;   ///< m/s^2
  static constexpr double kSaturatedGyro = 4;  ///< below that nothing is called saturated
  static constexpr double kSaturatedAccel = 18;
  static constexpr double kHole = 4;

 private:
  struct Trouble {
    std::size_t count = 0;
    std::size_t line = 0;  ///< the first
  };
  static void note(Trouble& trouble, std::size_t line) {
    if (trouble.count++ == 0) trouble.line = line;
  }
  void drop_saturated();

  std::string path_;
  std::vector<ImuSample> samples_;
  std::vector<std::size_t> lines_;
  Trouble missing_, absurd_, backwards_, saturated_;
};

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_IMU_CHECK_H
