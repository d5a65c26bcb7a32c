// The back-end's kernels and host steps, for whoever runs, checks, packages or lists them.
#ifndef PARTITA_HOST_TASKS_BACKEND_KERNELS_H
#define PARTITA_HOST_TASKS_BACKEND_KERNELS_H

#include <vector>

#include "host/runtime/kernel_spec.h"
#include "host/tasks/backend/problem.h"

namespace partita::backend {

/// `full`: doubles, CPU and GPU variants. `single`: floats and fixed-point sums, one work-item, for
/// FPGAs (and, the same text, for emulating them quickly).
enum class Precision { full, single };
/// What a variant computes in.
Precision precision_of(runtime::Variant variant);

/// The kernels of one camera model in one precision. Shape of all: cameras, points, observations,
/// slots, chunks, pairs, entries, loss (as Loss).
struct Kernels {
  runtime::KernelSpec jacobian_update;   ///< JU: Jacobians; U and g per chunk
  runtime::KernelSpec point_update;      ///< JU: V and b per point
  runtime::KernelSpec eliminate_points;  ///< SE: factors of V + D; Z
  runtime::KernelSpec schur_complement;  ///< SE: the reduced system, block by block
  runtime::KernelSpec back_substitute;   ///< CC: the points' steps
  runtime::KernelSpec cost;              ///< CC: the robust cost per chunk

  std::vector<const runtime::KernelSpec*> list() const;
};
const Kernels& kernels(CameraModel model, Precision precision);

/// All kernels of the task; Session wants them.
std::vector<const runtime::KernelSpec*> kernel_specs();

/// CFS. Shape: unknowns, terms (of the factor: unknowns^3 / 3 multiply-adds where it is dense).
const runtime::HostSpec& factorise_spec();
/// GRE. Shape: unknowns, cameras, chunks, groups.
const runtime::HostSpec& gain_ratio_spec();
std::vector<const runtime::HostSpec*> host_specs();

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_KERNELS_H
