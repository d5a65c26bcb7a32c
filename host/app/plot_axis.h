// An axis: from values to pixels, and where its ticks are.
#ifndef PARTITA_HOST_APP_PLOT_AXIS_H
#define PARTITA_HOST_APP_PLOT_AXIS_H

#include <string>
#include <vector>

#include "host/app/plot.h"

namespace partita::app::plot {

struct Tick {
  double value = 0;
  std::string label;
};

class Axis {
 public:
  /// Shows at least `least` to `most`, on the pixels `from` to `to`. Logarithmic where the values
  /// span more than `kLogarithmic` times and are above 0.
  Axis(double least, double most, double from, double to);
  static constexpr double kLogarithmic = 6;

  double operator()(double value) const;
  bool logarithmic() const { return logarithmic_; }
  /// About `count` of them at 1, 2 or 5 times a power of ten.
  std::vector<Tick> ticks(std::size_t count) const;

 private:
  double least_, most_, from_, to_;
  bool logarithmic_ = false;
};

/// A step of 1, 2 or 5 times a power of ten, of which about `count` make up `span`.
double nice_step(double span, std::size_t count);

}  // namespace partita::app::plot

#endif  // PARTITA_HOST_APP_PLOT_AXIS_H
