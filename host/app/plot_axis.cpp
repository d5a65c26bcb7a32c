#include "host/app/plot_axis.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace partita::app::plot {
namespace {

/// Room on both sides, so that no mark sits on the frame.
constexpr double kRoom = 0.04;

}  // namespace

double nice_step(double span, std::size_t count) {
  const double rough = span / static_cast<double>(std::max<std::size_t>(count, 1));
  const double power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (rough <= factor * power * 1.0001) return factor * power;
  }
  return 10 * power;
}

Axis::Axis(double least, double most, double from, double to)
    : least_(least), most_(most), from_(from), to_(to) {
  logarithmic_ = least > 0 && most / least > kLogarithmic;
  if (logarithmic_) {
    const double room = std::pow(most / least, kRoom);
    least_ /= room;
    most_ *= room;
    return;
  }
  // A single value gets an axis around it.
  double span = most - least;
  if (span <= 0) span = most > 0 ? 0.2 * most : 1;
  least_ = std::max(least > 0 ? 0.0 : least, least - kRoom * span);
  most_ = most + kRoom * span;
}

double Axis::operator()(double value) const {
  const double share = logarithmic_ ? std::log(value / least_) / std::log(most_ / least_)
                                    : (value - least_) / (most_ - least_);
  return from_ + share * (to_ - from_);
}

std::vector<Tick> Axis::ticks(std::size_t count) const {
  std::vector<Tick> ticks;
  if (logarithmic_) {
    // Over many powers of ten, only those.
    const bool all = std::log10(most_ / least_) * 3 <= 1.5 * static_cast<double>(count);
    for (double power = std::pow(10, std::floor(std::log10(least_))); power <= most_; power *= 10) {
      for (const double factor : {1.0, 2.0, 5.0}) {
        const double value = factor * power;
        const bool inside = value >= least_ && value <= most_;
        if (inside && (all || factor == 1)) ticks.push_back({value, fmt::format("{:g}", value)});
      }
    }
    return ticks;
  }
  const double step = nice_step(most_ - least_, count);
  for (double k = std::ceil(least_ / step); k * step <= most_ * (1 + 1e-12); ++k) {
    ticks.push_back({k * step, fmt::format("{:g}", k * step)});
  }
  return ticks;
}

}  // namespace partita::app::plot
