// Work of the bundle adjustment kernels, per camera model and precision.
#ifndef PARTITA_HOST_TASKS_BACKEND_WORK_H
#define PARTITA_HOST_TASKS_BACKEND_WORK_H

#include "host/tasks/backend/kernels.h"
#include "host/tasks/backend/layout.h"

namespace partita::backend {

struct WorkModel {
  CameraModel model = CameraModel::bal;
  Precision precision = Precision::full;

  Work jacobian_update(runtime::Variant variant, const runtime::Shape& shape) const;
  Work point_update(runtime::Variant variant, const runtime::Shape& shape) const;
  Work eliminate_points(runtime::Variant variant, const runtime::Shape& shape) const;
  Work schur_complement(runtime::Variant variant, const runtime::Shape& shape) const;
  Work back_substitute(runtime::Variant variant, const runtime::Shape& shape) const;
  Work cost(runtime::Variant variant, const runtime::Shape& shape) const;
};

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_WORK_H
