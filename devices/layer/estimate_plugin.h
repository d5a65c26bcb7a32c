// The border to libpartita_estimate.so, which reads compiled code with LLVM. It is a library of
// its own, loaded when the first kernel without declared Work is launched, so that programs that
// declare their Work, and machines without LLVM's library, never load it.
#ifndef PARTITA_DEVICES_LAYER_ESTIMATE_PLUGIN_H
#define PARTITA_DEVICES_LAYER_ESTIMATE_PLUGIN_H

#include <cstddef>
#include <cstdint>

#include "devices/work.h"

namespace partita::layer {

/// `bitcode` is LLVM bitcode of a program, `kernel` a kernel in it. `unknown_trips` is the count
/// of loops that do not tell theirs. Writes operations, bytes and `iterations` of one work-item
/// and returns 0; returns 1 if the kernel is not there or the bitcode cannot be read.
using EstimateFn = int (*)(const void* bitcode, std::size_t bytes, const char* kernel,
                           std::uint64_t unknown_trips, Work* per_item, std::uint64_t* iterations);
inline constexpr const char* kEstimateFunction = "partita_estimate";
inline constexpr const char* kEstimateLibrary = "libpartita_estimate.so";

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_ESTIMATE_PLUGIN_H
