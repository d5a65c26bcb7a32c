// Work that a host thread has declared for its next kernel on a queue.
#ifndef PARTITA_DEVICES_LAYER_DECLARED_WORK_H
#define PARTITA_DEVICES_LAYER_DECLARED_WORK_H

#include <CL/cl.h>

#include "devices/work.h"

namespace partita::layer {

/// The calling thread's declaration for `queue`, which it uses up; false if there is none.
bool take_declared_work(cl_command_queue queue, Work& work);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_DECLARED_WORK_H
