// Accounting for the memory of emulated devices.
#ifndef PARTITA_DEVICES_LAYER_MEMORY_H
#define PARTITA_DEVICES_LAYER_MEMORY_H

#include <memory>

#include "devices/layer/state.h"

namespace partita::layer {

/// Takes `bytes` of the memory of all the context's devices for an entry that is to be registered;
/// the entry's destructor gives them back. Null with `error` set if they do not have it.
std::shared_ptr<Memory> reserve(std::shared_ptr<Context> context, std::uint64_t bytes,
                                cl_int& error);

/// Whether any of the context's devices has images and samplers.
bool has_images(const Context& context);

std::shared_ptr<Memory> find_memory(cl_mem handle);
void register_memory(cl_mem handle, std::shared_ptr<Memory> memory);

/// CL_MEM_COPY_HOST_PTR: the host waits while the bytes cross to the (only) device.
void charge_initial_copy(const Context& context, std::uint64_t bytes);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_MEMORY_H
