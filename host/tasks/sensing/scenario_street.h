// The street as a whole: what there is around the vehicle at one moment.
#ifndef PARTITA_HOST_TASKS_SENSING_SCENARIO_STREET_H
#define PARTITA_HOST_TASKS_SENSING_SCENARIO_STREET_H

#include <cstdint>
#include <vector>

#include "host/tasks/sensing/frame.h"
#include "host/tasks/sensing/scenario_motion.h"
#include "host/tasks/sensing/scenario_raster.h"

namespace partita::sensing::scenario {

/// A road user in the scene; its index is that of Face::object.
struct RoadUser {
  ObjectClass object_class = ObjectClass::car;
  int id = 0;   ///< the same at every moment
  Vec3 centre;  ///< world, metres
};

struct World {
  Scene scene;
  std::vector<RoadUser> users;
};

/// Builds what can be seen `seconds` after the start. The street has no end: houses, trees and road
/// users are drawn from hashes of their position along it, so any moment can be built by itself.
World build_world(const Street& street, const TextureSet& textures, std::uint64_t seed,
                  double seconds);

}  // namespace partita::sensing::scenario

#endif  // PARTITA_HOST_TASKS_SENSING_SCENARIO_STREET_H
