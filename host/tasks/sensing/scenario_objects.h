// What stands and moves on the street.
#ifndef PARTITA_HOST_TASKS_SENSING_SCENARIO_OBJECTS_H
#define PARTITA_HOST_TASKS_SENSING_SCENARIO_OBJECTS_H

#include <cstdint>

#include "host/tasks/sensing/scenario_solids.h"

namespace partita::sensing::scenario {

// Each stands on its place's origin and faces its forward axis; `seed` draws how this one looks.
void add_car(Builder& builder, const Place& place, const TextureSet& textures, std::uint64_t seed);

/// `phase` is that of the gait and of the pedals, in radians.
void add_pedestrian(Builder& builder, const Place& place, const TextureSet& textures,
                    std::uint64_t seed, double phase);
void add_cyclist(Builder& builder, const Place& place, const TextureSet& textures,
                 std::uint64_t seed, double phase);

void add_tree(Builder& builder, const Place& place, const TextureSet& textures, std::uint64_t seed);

/// Its arm reaches towards the place's right.
void add_lamp(Builder& builder, const Place& place, const TextureSet& textures);

/// `side` +1: the house lies to the right of its place, -1: to the left. Its front is the plane
/// through the origin; at most kHouseLength long.
void add_house(Builder& builder, const Place& place, const TextureSet& textures, std::uint64_t seed,
               int side);
inline constexpr double kHouseLength = 12.8;

}  // namespace partita::sensing::scenario

#endif  // PARTITA_HOST_TASKS_SENSING_SCENARIO_OBJECTS_H
