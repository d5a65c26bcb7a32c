#include "host/tasks/sensing/geodesy.h"

#include <cmath>

namespace partita::sensing {
namespace {

constexpr double kRadians = 3.14159265358979323846 / 180;
constexpr double kSemiMajor = 6378137.0;  // WGS 84
constexpr double kFlattening = 1 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2 - kFlattening);

Eigen::Vector3d to_ecef(const Geodetic& g) {
  const double phi = g.latitude * kRadians, lambda = g.longitude * kRadians;
  const double s = std::sin(phi);
  const double N = kSemiMajor / std::sqrt(1 - kEccentricity2 * s * s);
  return {(N + g.height) * std::cos(phi) * std::cos(lambda),
          (N + g.height) * std::cos(phi) * std::sin(lambda),
          (N * (1 - kEccentricity2) + g.height) * s};
}

}  // namespace

LocalMap::LocalMap(const Geodetic& origin) : origin_(origin), origin_ecef_(to_ecef(origin)) {
  const double phi = origin.latitude * kRadians, lambda = origin.longitude * kRadians;
  const double sp = std::sin(phi), cp = std::cos(phi), sl = std::sin(lambda), cl = std::cos(lambda);
  R_map_ecef_ << -sl, cl, 0, -sp * cl, -sp * sl, cp, cp * cl, cp * sl, sp;
}

Eigen::Vector3d LocalMap::to_map(const Geodetic& place) const {
  return R_map_ecef_ * (to_ecef(place) - origin_ecef_);
}

}  // namespace partita::sensing
