// Random problems, and from them the inputs of every kernel for checking it.
#ifndef PARTITA_HOST_TASKS_BACKEND_CASES_H
#define PARTITA_HOST_TASKS_BACKEND_CASES_H

#include <cstdint>

#include "host/runtime/kernel_spec.h"
#include "host/tasks/backend/kernels.h"
#include "host/tasks/backend/problem.h"

namespace partita::backend {

/// Cameras before a cloud of points, everything known but for errors: of half a pixel in the
/// measurements, small ones in the state. About `seen` cameras see a point; some points none, some
/// cameras a point twice.
Problem random_problem(CameraModel model, int cameras, int points, int seen, std::uint32_t seed);

/// The case of a kernel with these arguments: what the golden kernels before it leave behind.
/// Shape: cameras, points, seen, loss.
runtime::KernelCase make_case(const std::vector<runtime::ArgSpec>& args, CameraModel model,
                              Precision precision, const runtime::Shape& shape, std::uint32_t seed);

enum class Golden {
  jacobian_update,
  point_update,
  eliminate_points,
  schur_complement,
  back_substitute,
  cost
};
/// Runs a golden kernel on a case of these arguments.
void run_golden(Golden kernel, const std::vector<runtime::ArgSpec>& args, CameraModel model,
                Precision precision, runtime::KernelCase& c);

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_CASES_H
