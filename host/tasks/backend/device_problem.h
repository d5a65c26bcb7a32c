// The device's side of a bundle adjustment: buffers and launches. T is what the kernels compute in.
#ifndef PARTITA_HOST_TASKS_BACKEND_DEVICE_PROBLEM_H
#define PARTITA_HOST_TASKS_BACKEND_DEVICE_PROBLEM_H

#include <array>
#include <vector>

#include "host/runtime/kernel.h"
#include "host/tasks/backend/camera.h"
#include "host/tasks/backend/kernels.h"
#include "host/tasks/backend/layout.h"
#include "host/tasks/backend/structure.h"

namespace partita::backend {

/// What elimination leaves for the host, in doubles whatever the device computes in.
struct Reduced {
  std::vector<double> blocks;       ///< of Structure::pairs
  std::vector<double> camera_sums;  ///< per camera: right-hand side, gradient, diagonal of U
};

/// The points' share of a step.
struct PointStep {
  double model = 0;   ///< twice the decrease that the model promises
  double square = 0;  ///< squared length, unscaled
  double norm = 0;    ///< squared length of the points
};

template <class T>
class DeviceProblem {
 public:
  DeviceProblem(const runtime::Session& session, const Problem& problem, const Structure& structure,
                Loss loss, double loss_scale);

  /// State 0 is the current one, 1 the trial.
  void write_cameras(int state, const std::vector<CameraRecord>& records);
  void write_point_scales(const std::vector<double>& scales);
  void read_points(std::vector<Point>& points);

  void update_jacobians();
  double point_gradient();  ///< largest component; after update_jacobians
  /// Sums over a camera's squared columns, and the points'; for the scales.
  void read_diagonals(std::vector<double>& cameras, std::vector<double>& points);
  void eliminate(double inverse_radius, Reduced& reduced);
  /// Scaled steps of the cameras, dof each; the trial points are the result.
  PointStep step_points(const std::vector<double>& steps, double inverse_radius);
  double cost(int state);
  /// The trial state becomes the current one.
  void accept();
  runtime::Shape shape() const { return shape_; }

 private:
  template <class U>
  cl::Buffer upload(const std::vector<U>& values);
  cl::Buffer reals(std::size_t count) const;
  void read(const cl::Buffer& buffer, std::vector<T>& values) const;

  const runtime::Session& session_;
  const Structure& structure_;
  Layout layout_;
  Loss loss_;
  T loss_scale_;
  runtime::Shape shape_;
  runtime::Kernel jacobian_update_, point_update_, eliminate_points_, schur_complement_,
      back_substitute_, cost_;
  std::array<cl::Buffer, 2> cameras_, points_;
  cl::Buffer point_scales_, chunks_, slot_points_, measured_, weights_, jacobians_, partials_;
  cl::Buffer point_start_, point_slots_, point_cameras_, blocks_, gradients_, factors_, eliminated_;
  cl::Buffer pairs_, entries_, camera_chunks_, reduced_, camera_sums_, steps_, sums_, costs_;
  std::vector<T> staging_, second_;
};

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_DEVICE_PROBLEM_H
