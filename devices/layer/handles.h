// Handles as arguments. PoCL follows every pointer that it is given; a program that passes null, or
// a handle of another kind, gets OpenCL's error from the layer instead of a crash below it.
#ifndef PARTITA_DEVICES_LAYER_HANDLES_H
#define PARTITA_DEVICES_LAYER_HANDLES_H

#include <algorithm>

#include "devices/layer/state.h"

namespace partita::layer {

/// CL_SUCCESS, or the error that OpenCL has for a handle that is none of its kind. Handles that no
/// table knows are the driver's to judge: a callback may get an event that the program released.
/// state().mutex is held.
cl_int check_handle(cl_context handle);
cl_int check_handle(cl_command_queue handle);
cl_int check_handle(cl_mem handle);
cl_int check_handle(cl_sampler handle);
cl_int check_handle(cl_program handle);
cl_int check_handle(cl_kernel handle);
cl_int check_handle(cl_event handle);

/// The same for a list; takes the mutex.
template <typename Handle>
bool valid_handles(cl_uint count, const Handle* list) {
  if (!list) return count == 0;
  const Lock lock(state().mutex);
  return std::all_of(list, list + count,
                     [](Handle handle) { return check_handle(handle) == CL_SUCCESS; });
}

/// Puts the checks in front of the table's entries, the layer's own and the driver's.
void guard_handles(cl_icd_dispatch& table);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_HANDLES_H
