// The limits of a launch, shared by enqueueing and by queries.
#ifndef PARTITA_DEVICES_LAYER_LAUNCH_H
#define PARTITA_DEVICES_LAYER_LAUNCH_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "devices/layer/state.h"

namespace partita::layer {

std::shared_ptr<Kernel> find_kernel(cl_kernel handle);

/// Work-items that one work-group of the kernel can have.
std::size_t group_limit(const Kernel& kernel, const Device& device);

/// Bytes of __local memory that the device charges: arrays inside an FPGA's kernel are part of its
/// area, so only arguments count there.
std::uint64_t local_memory(const Kernel& kernel, const Device& device);

using Sizes = std::array<std::size_t, 3>;

/// Checks a launch against device and kernel. `given` is null if the program left the local size
/// open; `local` is then chosen: the largest divisors, first dimension first, of at most 256
/// work-items. It depends on the sizes alone, so that a prediction does.
cl_int check_launch(const Kernel& kernel, const Device& device, cl_uint dimensions,
                    const std::size_t* global, const std::size_t* given, Sizes& local);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_LAUNCH_H
