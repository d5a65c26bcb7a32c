// Work for kernels of programs that declare none: operations counted in the compiled code.
#ifndef PARTITA_DEVICES_LAYER_ESTIMATE_H
#define PARTITA_DEVICES_LAYER_ESTIMATE_H

#include <memory>

#include "devices/layer/state.h"

namespace partita::layer {

/// Trips of a loop whose count the compiler cannot tell.
inline constexpr std::uint64_t kDefaultTrips = 16;

/// What a work-item is taken to do if its code cannot be read at all: 32 additions, 32
/// multiply-adds, 64 bytes read and 16 written.
ItemEstimate fallback_estimate();

/// The kernel's estimate, made at the first call and kept. Calls the driver: the state's mutex is
/// not held.
std::shared_ptr<const ItemEstimate> estimate_of(cl_kernel handle, Kernel& kernel);

/// The Work of `items` work-items, marked as estimated. `reachable` is the size of the buffers
/// that the launch was given: more than that cannot cross the memory bus once.
Work estimated_work(const ItemEstimate& estimate, std::uint64_t items, std::uint64_t reachable,
                    const ContainerKernel* circuit);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_ESTIMATE_H
