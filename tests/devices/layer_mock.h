// A driver that executes nothing: one platform, one CPU device of four units, objects with
// reference counts, and commands that complete as soon as what they wait for has. It lets the
// layer's own logic be tested without PoCL, under the sanitizers and with many threads.
#ifndef PARTITA_TESTS_DEVICES_LAYER_MOCK_H
#define PARTITA_TESTS_DEVICES_LAYER_MOCK_H

#include <cstdint>

#include <CL/cl_icd.h>

namespace partita::mock {

/// The driver's table. Kernels are known by name, whatever the source says: all have the arguments
/// (global, local); "task" requires the work-group size (1, 1, 1); "wide_local" has 40,000 bytes
/// of static local memory. Source that contains "syntax error" does not build.
const cl_icd_dispatch& driver();

/// Objects of the driver that are still alive.
std::int64_t live_objects();

/// The layer's table on top of the driver, with the machine that PARTITA_MACHINE names. The layer
/// is initialised at the first call.
const cl_icd_dispatch& layer();

}  // namespace partita::mock

#endif  // PARTITA_TESTS_DEVICES_LAYER_MOCK_H
