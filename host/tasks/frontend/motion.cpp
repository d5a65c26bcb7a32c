#include "host/tasks/frontend/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <ceres/ceres.h>
#include <ceres/rotation.h>

namespace partita::frontend {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix26d = Eigen::Matrix<double, 2, 6>;

constexpr double kNearest = 0.1;      ///< metres in front of the camera
constexpr int kSampleIterations = 8;  ///< Gauss-Newton steps of a hypothesis
constexpr double kPixelSigma = 0.4;   ///< of a refined position
constexpr double kDisparitySigma = 0.3;
constexpr double kLossScale = 1.5;  ///< in standard deviations

Eigen::Vector2d project(const Eigen::Vector3d& p, const StereoCalibration& calibration) {
  return {calibration.fx * p.x() / p.z() + calibration.cx,
          calibration.fy * p.y() / p.z() + calibration.cy};
}

Eigen::Matrix<double, 2, 3> projection_jacobian(const Eigen::Vector3d& p,
                                                const StereoCalibration& calibration) {
  Eigen::Matrix<double, 2, 3> J;
  J << calibration.fx / p.z(), 0, -calibration.fx * p.x() / (p.z() * p.z()), 0,
      calibration.fy / p.z(), -calibration.fy * p.y() / (p.z() * p.z());
  return J;
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Pose moved(const Pose& pose, const Vector6d& step) {
  const Eigen::Vector3d rotation = step.head<3>();
  const double angle = rotation.norm();
  Pose out = Pose::Identity();
  if (angle > 0) out.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  out.linear() = out.linear() * pose.linear();
  out.translation() = pose.translation() + step.tail<3>();
  return out;
}

/// Gauss-Newton on three points. False if it does not settle.
bool fit_sample(std::span<const Observation> observations, const std::array<std::size_t, 3>& sample,
                const StereoCalibration& calibration, Pose& pose) {
  for (int iteration = 0; iteration < kSampleIterations; ++iteration) {
    Matrix6d normal = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    for (const std::size_t i : sample) {
      const Eigen::Vector3d rotated = pose.linear() * observations[i].point;
      const Eigen::Vector3d p = rotated + pose.translation();
      if (p.z() < kNearest) return false;
      const auto to_pixel = projection_jacobian(p, calibration);
      Matrix26d J;
      J.leftCols<3>() = -to_pixel * cross_matrix(rotated);
      J.rightCols<3>() = to_pixel;
      normal += J.transpose() * J;
      gradient += J.transpose() * (observations[i].pixel - project(p, calibration));
    }
    const Vector6d step = normal.ldlt().solve(gradient);
    if (!step.allFinite()) return false;
    pose = moved(pose, step);
    if (step.norm() < 1e-6) return true;
  }
  return false;
}

/// xorshift: the sequence of samples is the same everywhere.
class Sampler {
 public:
  explicit Sampler(std::size_t count) : count_(count) {}
  std::array<std::size_t, 3> next() {
    std::array<std::size_t, 3> sample{};
    do {
      for (std::size_t& i : sample) i = draw();
    } while (sample[0] == sample[1] || sample[0] == sample[2] || sample[1] == sample[2]);
    return sample;
  }

 private:
  std::size_t draw() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return static_cast<std::size_t>(state_ >> 33) % count_;
  }
  std::size_t count_;
  std::uint64_t state_ = 0x9E3779B97F4A7C15u;
};

int find_inliers(std::span<const Observation> observations, const StereoCalibration& calibration,
                 const Pose& pose, double bound, std::vector<bool>& inliers) {
  inliers.assign(observations.size(), false);
  int count = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    inliers[i] = reprojection_error(observations[i], calibration, pose) <= bound;
    count += inliers[i] ? 1 : 0;
  }
  return count;
}

/// Reprojection residual over (angle axis, translation), whitened with the covariance of the pixel
/// and of the landmark's depth, which the disparity's error dominates: near points say much about
/// the translation, far ones little, although both are seen equally sharply.
struct Residual {
  const Observation& observation;
  const StereoCalibration& calibration;
  Eigen::Matrix2d whitening;

  template <typename T>
  bool operator()(const T* pose, T* residual) const {
    const std::array<T, 3> point{T(observation.point.x()), T(observation.point.y()),
                                 T(observation.point.z())};
    std::array<T, 3> p;
    ceres::AngleAxisRotatePoint(pose, point.data(), p.data());
    for (std::size_t i = 0; i < 3; ++i) p[i] += pose[3 + i];
    if (p[2] < T(kNearest)) return false;
    const T du = T(calibration.fx) * p[0] / p[2] + T(calibration.cx - observation.pixel.x());
    const T dv = T(calibration.fy) * p[1] / p[2] + T(calibration.cy - observation.pixel.y());
    residual[0] = T(whitening(0, 0)) * du + T(whitening(0, 1)) * dv;
    residual[1] = T(whitening(1, 0)) * du + T(whitening(1, 1)) * dv;
    return true;
  }
};

/// Inverse of the Cholesky factor of the residual's covariance at `pose`.
Eigen::Matrix2d whitening(const Observation& observation, const StereoCalibration& calibration,
                          const Pose& pose) {
  const double disparity = calibration.fx * calibration.baseline / observation.point.z();
  const Eigen::Vector3d p = pose * observation.point;
  // d point / d disparity = -point / disparity.
  const Eigen::Vector2d by_disparity = projection_jacobian(p, calibration) *
                                       (pose.linear() * observation.point) * (-1.0 / disparity);
  const Eigen::Matrix2d covariance =
      kPixelSigma * kPixelSigma * Eigen::Matrix2d::Identity() +
      kDisparitySigma * kDisparitySigma * by_disparity * by_disparity.transpose();
  const Eigen::Matrix2d lower = covariance.llt().matrixL();
  return lower.inverse();
}

/// Least squares over the inliers from `pose`; returns the iterations.
int polish(std::span<const Observation> observations, const std::vector<bool>& inliers,
           const StereoCalibration& calibration, Pose& pose) {
  std::array<double, 6> state{};
  const Eigen::Matrix3d rotation = pose.linear();
  ceres::RotationMatrixToAngleAxis(rotation.data(), state.data());
  Eigen::Map<Eigen::Vector3d>(state.data() + 3) = pose.translation();

  ceres::Problem problem;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!inliers[i]) continue;
    auto* cost = new ceres::AutoDiffCostFunction<Residual, 2, 6>(
        new Residual{observations[i], calibration, whitening(observations[i], calibration, pose)});
    problem.AddResidualBlock(cost, new ceres::CauchyLoss(kLossScale), state.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.max_num_iterations = 20;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return 0;

  Eigen::Matrix3d solved;
  ceres::AngleAxisToRotationMatrix(state.data(), solved.data());
  pose.linear() = solved;
  pose.translation() = Eigen::Map<Eigen::Vector3d>(state.data() + 3);
  return summary.num_successful_steps + summary.num_unsuccessful_steps;
}

}  // namespace

double reprojection_error(const Observation& observation, const StereoCalibration& calibration,
                          const Pose& T_current_reference) {
  const Eigen::Vector3d p = T_current_reference * observation.point;
  if (p.z() < kNearest) return std::numeric_limits<double>::infinity();
  return (project(p, calibration) - observation.pixel).norm();
}

Pose scaled_motion(const Pose& motion, double times) {
  const Eigen::AngleAxisd rotation(motion.linear());
  Pose out = Pose::Identity();
  out.linear() = Eigen::AngleAxisd(rotation.angle() * times, rotation.axis()).toRotationMatrix();
  out.translation() = motion.translation() * times;
  return out;
}

MotionEstimate estimate_motion(std::span<const Observation> observations,
                               const StereoCalibration& calibration, const Pose& predicted,
                               const FrontendParameters& parameters) {
  MotionEstimate best;
  best.T_current_reference = predicted;
  best.inliers.assign(observations.size(), false);
  if (observations.size() < 3) return best;
  const double bound = parameters.inlier_bound;
  best.inlier_count = find_inliers(observations, calibration, predicted, bound, best.inliers);
  best.hypotheses = parameters.ransac_hypotheses + 1;

  Sampler sampler(observations.size());
  std::vector<bool> inliers;
  for (int i = 0; i < parameters.ransac_hypotheses; ++i) {
    Pose pose = predicted;
    if (!fit_sample(observations, sampler.next(), calibration, pose)) continue;
    const int count = find_inliers(observations, calibration, pose, bound, inliers);
    if (count <= best.inlier_count) continue;
    best.inlier_count = count;
    best.T_current_reference = pose;
    best.inliers = inliers;
  }
  // Twice, as the polished pose finds inliers that three points missed.
  for (int round = 0; round < 2 && best.inlier_count >= 3; ++round) {
    best.iterations += polish(observations, best.inliers, calibration, best.T_current_reference);
    best.inlier_count =
        find_inliers(observations, calibration, best.T_current_reference, bound, best.inliers);
  }
  return best;
}

}  // namespace partita::frontend
