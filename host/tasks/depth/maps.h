// Made-up maps of disparities for checking the kernels that work on such maps.
#ifndef PARTITA_HOST_TASKS_DEPTH_MAPS_H
#define PARTITA_HOST_TASKS_DEPTH_MAPS_H

#include "host/runtime/kernel_spec.h"
#include "host/tasks/depth/golden.h"

namespace partita::depth {

/// Surfaces that bend and end at jumps, with noise on them, holes, and grains that belong to
/// nothing.
runtime::HostArray random_map(Size size, std::uint32_t seed);

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_MAPS_H
