// Residuals as templates for automatic derivatives, over the parameters of problem.h.
#ifndef PARTITA_HOST_TASKS_BACKEND_PROJECTION_FUNCTORS_H
#define PARTITA_HOST_TASKS_BACKEND_PROJECTION_FUNCTORS_H

#include <ceres/rotation.h>

#include "host/tasks/backend/problem.h"

namespace partita::backend {

struct BalResidual {
  double x, y, weight;
  template <class T>
  bool operator()(const T* camera, const T* point, T* residual) const {
    T p[3];
    ceres::AngleAxisRotatePoint(camera, point, p);
    for (int i = 0; i < 3; ++i) p[i] += camera[3 + i];
    const T px = -p[0] / p[2], py = -p[1] / p[2], n = px * px + py * py;
    const T factor = camera[6] * (1.0 + n * (camera[7] + n * camera[8]));
    residual[0] = weight * (factor * px - x);
    residual[1] = weight * (factor * py - y);
    return true;
  }
};

struct StereoResidual {
  StereoRig rig;
  std::array<double, 3> measured;
  double weight;
  template <class T>
  bool operator()(const T* camera, const T* point, T* residual) const {
    T p[3];
    ceres::AngleAxisRotatePoint(camera, point, p);
    for (int i = 0; i < 3; ++i) p[i] += camera[3 + i];
    residual[0] = weight * (rig.fx * p[0] / p[2] + rig.cx - measured[0]);
    residual[1] = weight * (rig.fy * p[1] / p[2] + rig.cy - measured[1]);
    residual[2] = weight * (rig.fx * (p[0] - rig.baseline) / p[2] + rig.cx - measured[2]);
    return true;
  }
};

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_PROJECTION_FUNCTORS_H
