#include "host/tasks/backend/device_problem.h"

#include <algorithm>
#include <span>

namespace partita::backend {
namespace {

using runtime::Shape;

template <class T>
constexpr Precision kPrecision = sizeof(T) == 8 ? Precision::full : Precision::single;

Shape make_shape(const Structure& s, Loss loss) {
  const auto size = [](const auto& list) { return static_cast<std::int64_t>(list.size()); };
  return {{"cameras", s.cameras},
          {"points", s.points},
          {"observations", size(s.point_slots)},
          {"slots", s.slots},
          {"chunks", size(s.chunks)},
          {"pairs", size(s.pairs)},
          {"entries", size(s.entries)},
          {"loss", static_cast<int>(loss)}};
}

}  // namespace

template <class T>
DeviceProblem<T>::DeviceProblem(const runtime::Session& session, const Problem& problem,
                                const Structure& structure, Loss loss, double loss_scale)
    : session_(session),
      structure_(structure),
      layout_(layout_of(problem.model)),
      loss_(loss),
      loss_scale_(static_cast<T>(loss_scale)),
      shape_(make_shape(structure, loss)),
      jacobian_update_(session, kernels(problem.model, kPrecision<T>).jacobian_update),
      point_update_(session, kernels(problem.model, kPrecision<T>).point_update),
      eliminate_points_(session, kernels(problem.model, kPrecision<T>).eliminate_points),
      schur_complement_(session, kernels(problem.model, kPrecision<T>).schur_complement),
      back_substitute_(session, kernels(problem.model, kPrecision<T>).back_substitute),
      cost_(session, kernels(problem.model, kPrecision<T>).cost) {
  const Structure& s = structure;
  const auto slots = static_cast<std::size_t>(s.slots);
  const auto points = static_cast<std::size_t>(s.points);
  const auto cameras = static_cast<std::size_t>(s.cameras);
  const auto residuals = static_cast<std::size_t>(layout_.residuals);
  const auto dof = static_cast<std::size_t>(layout_.dof);
  const std::size_t groups = (points + kGroupPoints - 1) / kGroupPoints;

  std::vector<T> measured(residuals * slots), weights(slots, 0), state(points * 3);
  for (std::size_t slot = 0; slot < slots; ++slot) {
    const int index = s.slot_observation[slot];
    if (index < 0) continue;
    const Observation& o = problem.observations[static_cast<std::size_t>(index)];
    for (std::size_t i = 0; i < residuals; ++i) {
      measured[i * slots + slot] = static_cast<T>(o.measured[i]);
    }
    weights[slot] = static_cast<T>(o.weight);
  }
  for (std::size_t i = 0; i < points * 3; ++i)
    state[i] = static_cast<T>(problem.points[i / 3][i % 3]);
  points_ = {upload(state), reals(points * 3)};
  cameras_ = {reals(cameras * kCameraStride), reals(cameras * kCameraStride)};
  measured_ = upload(measured);
  weights_ = upload(weights);
  chunks_ = upload(s.chunks);
  slot_points_ = upload(s.slot_point);
  point_start_ = upload(s.point_start);
  point_slots_ = upload(s.point_slots);
  point_cameras_ = upload(s.point_cameras);
  pairs_ = upload(s.pairs);
  entries_ = upload(s.entries);
  camera_chunks_ = upload(s.camera_chunks);
  point_scales_ = reals(points * 3);
  jacobians_ = reals(slots * static_cast<std::size_t>(layout_.jacobian_stride));
  partials_ = reals(s.chunks.size() * static_cast<std::size_t>(layout_.partial()));
  blocks_ = reals(points * kPointBlock);
  gradients_ = reals(groups);
  factors_ = reals(points * kPointBlock);
  eliminated_ = reals(slots * kEliminatedStride);
  reduced_ = reals(s.pairs.size() * dof * dof);
  camera_sums_ = reals(cameras * 3 * dof);
  steps_ = reals(cameras * kStepStride);
  sums_ = reals(groups * 3);
  costs_ = reals(s.chunks.size());
  session_.finish();  // the vectors above die here
}

template <class T>
template <class U>
cl::Buffer DeviceProblem<T>::upload(const std::vector<U>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  cl::Buffer buffer = session_.make_buffer(std::max<std::size_t>(bytes.size(), 64));
  if (!bytes.empty()) session_.write(buffer, bytes);
  return buffer;
}

template <class T>
cl::Buffer DeviceProblem<T>::reals(std::size_t count) const {
  return session_.make_buffer(std::max<std::size_t>(count * sizeof(T), 64));
}

template <class T>
void DeviceProblem<T>::read(const cl::Buffer& buffer, std::vector<T>& values) const {
  if (!values.empty()) session_.read(buffer, std::as_writable_bytes(std::span(values)));
}

template <class T>
void DeviceProblem<T>::write_cameras(int state, const std::vector<CameraRecord>& records) {
  session_.finish();  // what was staged before has arrived
  staging_.resize(records.size() * kCameraStride);
  for (std::size_t i = 0; i < staging_.size(); ++i) {
    staging_[i] = static_cast<T>(records[i / kCameraStride][i % kCameraStride]);
  }
  session_.write(cameras_[static_cast<std::size_t>(state)], std::as_bytes(std::span(staging_)));
}

template <class T>
void DeviceProblem<T>::write_point_scales(const std::vector<double>& scales) {
  const std::vector<T> values(scales.begin(), scales.end());
  session_.write(point_scales_, std::as_bytes(std::span(values)));
  session_.finish();
}

template <class T>
void DeviceProblem<T>::read_points(std::vector<Point>& points) {
  std::vector<T> values(points.size() * 3);
  read(points_[0], values);
  for (std::size_t i = 0; i < values.size(); ++i)
    points[i / 3][i % 3] = static_cast<double>(values[i]);
}

template <class T>
void DeviceProblem<T>::update_jacobians() {
  const auto chunks = static_cast<std::int32_t>(structure_.chunks.size());
  jacobian_update_.launch(shape_, cameras_[0], points_[0], point_scales_, chunks_, slot_points_,
                          measured_, weights_, jacobians_, partials_, structure_.slots, chunks,
                          static_cast<std::int32_t>(loss_), loss_scale_);
  point_update_.launch(shape_, jacobians_, point_start_, point_slots_, point_scales_, blocks_,
                       gradients_, structure_.points);
  session_.finish();
}

template <class T>
double DeviceProblem<T>::point_gradient() {
  std::vector<T> values((static_cast<std::size_t>(structure_.points) + kGroupPoints - 1) /
                        kGroupPoints);
  read(gradients_, values);
  return values.empty() ? 0 : static_cast<double>(*std::max_element(values.begin(), values.end()));
}

template <class T>
void DeviceProblem<T>::read_diagonals(std::vector<double>& cameras, std::vector<double>& points) {
  const auto dof = static_cast<std::size_t>(layout_.dof);
  const auto partial = static_cast<std::size_t>(layout_.partial());
  std::vector<T> sums(structure_.chunks.size() * partial);
  std::vector<T> blocks(static_cast<std::size_t>(structure_.points) * kPointBlock);
  read(partials_, sums);
  read(blocks_, blocks);
  cameras.assign(static_cast<std::size_t>(structure_.cameras) * dof, 0.0);
  for (std::size_t chunk = 0; chunk < structure_.chunks.size(); ++chunk) {
    const auto camera = static_cast<std::size_t>(structure_.chunks[chunk][0]);
    for (std::size_t i = 0; i < dof; ++i) {
      cameras[camera * dof + i] += static_cast<double>(sums[chunk * partial + i * dof + i]);
    }
  }
  points.resize(static_cast<std::size_t>(structure_.points) * 3);
  constexpr std::array<std::size_t, 3> kDiagonal{0, 3, 5};
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = static_cast<double>(blocks[i / 3 * kPointBlock + kDiagonal[i % 3]]);
  }
}

template <class T>
void DeviceProblem<T>::eliminate(double inverse_radius, Reduced& reduced) {
  eliminate_points_.launch(shape_, jacobians_, point_start_, point_slots_, blocks_, factors_,
                           eliminated_, structure_.points, static_cast<T>(inverse_radius));
  schur_complement_.launch(shape_, eliminated_, partials_, pairs_, entries_, camera_chunks_,
                           reduced_, camera_sums_,
                           static_cast<std::int32_t>(structure_.pairs.size()));
  const auto block = static_cast<std::size_t>(layout_.block());
  const auto sums = static_cast<std::size_t>(structure_.cameras * 3 * layout_.dof);
  if constexpr (sizeof(T) == sizeof(double)) {
    reduced.blocks.resize(structure_.pairs.size() * block);
    reduced.camera_sums.resize(sums);
    read(reduced_, reduced.blocks);
    read(camera_sums_, reduced.camera_sums);
  } else {
    staging_.resize(structure_.pairs.size() * block);
    second_.resize(sums);
    read(reduced_, staging_);
    read(camera_sums_, second_);
    reduced.blocks.assign(staging_.begin(), staging_.end());
    reduced.camera_sums.assign(second_.begin(), second_.end());
  }
}

template <class T>
PointStep DeviceProblem<T>::step_points(const std::vector<double>& steps, double inverse_radius) {
  const auto dof = static_cast<std::size_t>(layout_.dof);
  second_.assign(static_cast<std::size_t>(structure_.cameras) * kStepStride, 0);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    second_[i / dof * kStepStride + i % dof] = static_cast<T>(steps[i]);
  }
  session_.write(steps_, std::as_bytes(std::span(second_)));
  back_substitute_.launch(shape_, eliminated_, factors_, blocks_, point_start_, point_slots_,
                          point_cameras_, steps_, point_scales_, points_[0], points_[1], sums_,
                          structure_.points, static_cast<T>(inverse_radius));
  std::vector<T> sums((static_cast<std::size_t>(structure_.points) + kGroupPoints - 1) /
                      kGroupPoints * 3);
  read(sums_, sums);
  PointStep result;
  for (std::size_t i = 0; i < sums.size(); i += 3) {
    result.model += static_cast<double>(sums[i]);
    result.square += static_cast<double>(sums[i + 1]);
    result.norm += static_cast<double>(sums[i + 2]);
  }
  return result;
}

template <class T>
double DeviceProblem<T>::cost(int state) {
  const auto which = static_cast<std::size_t>(state);
  const auto chunks = static_cast<std::int32_t>(structure_.chunks.size());
  cost_.launch(shape_, cameras_[which], points_[which], chunks_, slot_points_, measured_, weights_,
               costs_, structure_.slots, chunks, static_cast<std::int32_t>(loss_), loss_scale_);
  std::vector<T> costs(structure_.chunks.size());
  read(costs_, costs);
  double sum = 0;
  for (const T cost : costs) sum += static_cast<double>(cost);
  return 0.5 * sum;
}

template <class T>
void DeviceProblem<T>::accept() {
  std::swap(cameras_[0], cameras_[1]);
  std::swap(points_[0], points_[1]);
}

template class DeviceProblem<double>;
template class DeviceProblem<float>;

}  // namespace partita::backend
