// Latitude, longitude and height as metres on a plane.
#ifndef PARTITA_HOST_TASKS_SENSING_GEODESY_H
#define PARTITA_HOST_TASKS_SENSING_GEODESY_H

#include <Eigen/Core>

namespace partita::sensing {

struct Geodetic {
  double latitude = 0;   ///< degrees north
  double longitude = 0;  ///< degrees east
  double height = 0;     ///< metres above the ellipsoid
};

/// East, north and up of an origin: the tangent plane of the WGS 84 ellipsoid there, through
/// earth-centred coordinates (exact, whatever the distance).
class LocalMap {
 public:
  explicit LocalMap(const Geodetic& origin);
  Eigen::Vector3d to_map(const Geodetic& place) const;
  const Geodetic& origin() const { return origin_; }

 private:
  Geodetic origin_;
  Eigen::Vector3d origin_ecef_;
  Eigen::Matrix3d R_map_ecef_;
};

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_GEODESY_H
