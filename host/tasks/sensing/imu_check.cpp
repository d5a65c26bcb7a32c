#include "host/tasks/sensing/imu_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace partita::sensing {

void ImuCheck::add(const ImuSample& sample, std::size_t line) {
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) {
    note(missing_, line);
  } else if (sample.gyro.cwiseAbs().maxCoeff() > kMostGyro ||
             sample.accel.cwiseAbs().maxCoeff() > kMostAccel) {
    note(absurd_, line);
  } else if (!samples_.empty() && sample.timestamp_ns <= samples_.back().timestamp_ns) {
    note(backwards_, line);
  } else {
    samples_.push_back(sample);
    lines_.push_back(line);
  }
}

/// A sensor at the end of its range repeats it to the last digit, and exceeds it nowhere.
void ImuCheck::drop_saturated() {
  std::vector<bool> drop(samples_.size(), false);
  for (int axis = 0; axis < 6; ++axis) {
    const auto value = [this, axis](std::size_t i) {
      return axis < 3 ? samples_[i].gyro[axis] : samples_[i].accel[axis - 3];
    };
    double extreme = axis < 3 ? kSaturatedGyro : kSaturatedAccel;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      extreme = std::max(extreme, std::abs(value(i)));
    }
    for (std::size_t i = 0; i < samples_.size();) {
      std::size_t end = i + 1;
      if (std::abs(value(i)) >= extreme) {
        while (end < samples_.size() && value(end) == value(i)) ++end;
        if (end - i >= 3)
          std::fill(drop.begin() + static_cast<long>(i), drop.begin() + static_cast<long>(end),
                    true);
      }
      i = end;
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    if (drop[i]) {
      note(saturated_, lines_[i]);
      continue;
    }
    samples_[kept] = samples_[i];
    lines_[kept++] = lines_[i];
  }
  samples_.resize(kept);
  lines_.resize(kept);
}

std::vector<ImuSample> ImuCheck::finish(std::vector<std::string>& notices) {
  drop_saturated();
  const auto tell = [&](const Trouble& trouble, const char* what) {
    if (trouble.count == 0) return;
    notices.push_back(fmt::format("{}:{}: {}; {} such inertial readings left out", path_,
                                  trouble.line, what, trouble.count));
  };
  tell(missing_, "not a number or empty");
  tell(absurd_, "beyond what any sensor measures");
  tell(backwards_, "the time does not increase");
  tell(saturated_, "at the end of the sensor's range");
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    steps.push_back(samples_[i].timestamp_ns - samples_[i - 1].timestamp_ns);
  }
  if (steps.empty()) return std::move(samples_);
  std::vector<std::int64_t> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double usual = static_cast<double>(*middle);
  Trouble holes;
  std::int64_t longest = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (static_cast<double>(steps[i]) <= kHole * usual) continue;
    note(holes, lines_[i + 1]);
    longest = std::max(longest, steps[i]);
  }
  if (holes.count > 0) {
    notices.push_back(
        fmt::format("{}:{}: inertial readings are missing before it; {} such holes, "
                    "the longest of {:.3f} s, are bridged",
                    path_, holes.line, holes.count, static_cast<double>(longest) * 1e-9));
  }
  return std::move(samples_);
}

}  // namespace partita::sensing
