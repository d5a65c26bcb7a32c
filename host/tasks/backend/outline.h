// The back-end as an outline (host/tasks/outline.h): bundle adjustment over a sliding window of
// key-frames by Levenberg-Marquardt, as the paper divides it: Jacobian update, Schur elimination
// and cost on the device, Cholesky factorisation and gain ratio on the host beside it.
#ifndef PARTITA_HOST_TASKS_BACKEND_OUTLINE_H
#define PARTITA_HOST_TASKS_BACKEND_OUTLINE_H

#include "host/tasks/program.h"

namespace partita::backend {

tasks::TaskExport outline(const tasks::Sensors& sensors);

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_OUTLINE_H
