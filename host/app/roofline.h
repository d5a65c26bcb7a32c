// What a device reaches at most, measured: the roof over the kernels' shares.
#ifndef PARTITA_HOST_APP_ROOFLINE_H
#define PARTITA_HOST_APP_ROOFLINE_H

#include "devices/work.h"
#include "host/runtime/device.h"

namespace partita::app {

struct Roofline {
  double flops = 0;      ///< per second, fp32 multiply-adds in registers, two operations each
  double bandwidth = 0;  ///< bytes per second, read plus written, of a copy larger than the caches

  /// Least seconds for so much work.
  double seconds(double operations, double bytes) const {
    const double computing = operations / flops, moving = bytes / bandwidth;
    return computing > moving ? computing : moving;
  }
};

/// The best of a few rounds, about a third of a second. For devices that take source.
Roofline measure_roofline(const runtime::Device& device);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_ROOFLINE_H
