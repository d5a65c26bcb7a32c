// Golden jacobian_update and cost: what happens slot by slot.
#include <bit>

#include "host/tasks/backend/golden.h"
#include "host/tasks/backend/golden_tools.h"

namespace partita::backend::golden {
namespace {

template <class T>
T dot(T a, T b, T c, T x, T y, T z) {
  return std::fma(c, z, std::fma(b, y, a * x));
}

template <class T>
struct Projection {
  T q[3];  ///< rotated point
  T inverse_z, x = 0, y = 0, square = 0, factor = 0, px, py;
};

template <class T>
Projection<T> project(const Inputs<T>& in, std::span<const T> camera, int slot, T* r) {
  Projection<T> s;
  const auto point = in.state.subspan(at(in.slot_points[at(slot)]) * 3, 3);
  const auto measured = [&](int i) { return in.measured[at(i) * at(in.slots) + at(slot)]; };
  for (int i = 0; i < 3; ++i) {
    s.q[i] = dot(camera[at(3 * i)], camera[at(3 * i + 1)], camera[at(3 * i + 2)], point[0],
                 point[1], point[2]);
  }
  s.px = s.q[0] + camera[9];
  s.py = s.q[1] + camera[10];
  const T z = s.q[2] + camera[11];
  if (in.stereo) {
    s.inverse_z = T(1) / z;
    r[0] = std::fma(camera[12] * s.px, s.inverse_z, camera[14]) - measured(0);
    r[1] = std::fma(camera[13] * s.py, s.inverse_z, camera[15]) - measured(1);
    r[2] = std::fma(camera[12] * (s.px - camera[16]), s.inverse_z, camera[14]) - measured(2);
    return s;
  }
  s.inverse_z = T(-1) / z;
  s.x = s.px * s.inverse_z;
  s.y = s.py * s.inverse_z;
  s.square = std::fma(s.y, s.y, s.x * s.x);
  s.factor = std::fma(std::fma(camera[14], s.square, camera[13]), s.square, T(1));
  r[0] = std::fma(camera[12] * s.factor, s.x, -measured(0));
  r[1] = std::fma(camera[12] * s.factor, s.y, -measured(1));
  return s;
}

/// d(residual)/d(point in the camera's frame), row by row.
template <class T>
void derivative(const Inputs<T>& in, std::span<const T> camera, const Projection<T>& s, T* A) {
  if (in.stereo) {
    const T a = camera[12] * s.inverse_z, b = camera[13] * s.inverse_z;
    const T rows[9] = {a, 0, -(a * s.px) * s.inverse_z,
                       0, b, -(b * s.py) * s.inverse_z,
                       a, 0, -(a * (s.px - camera[16])) * s.inverse_z};
    std::copy(rows, rows + 9, A);
    return;
  }
  const T e = (camera[12] * T(2)) * std::fma(camera[14] * T(2), s.square, camera[13]);
  const T fd = camera[12] * s.factor;
  const T a = std::fma(e * s.x, s.x, fd), b = e * s.x * s.y, c = std::fma(e * s.y, s.y, fd);
  const T rows[6] = {a * s.inverse_z, b * s.inverse_z, std::fma(b, s.y, a * s.x) * s.inverse_z,
                     b * s.inverse_z, c * s.inverse_z, std::fma(c, s.y, b * s.x) * s.inverse_z};
  std::copy(rows, rows + 6, A);
}

template <class T>
T squared_norm(const Inputs<T>& in, const T* r) {
  T s = std::fma(r[1], r[1], r[0] * r[0]);
  if (in.stereo) s = std::fma(r[2], r[2], s);
  return s;
}

/// The kernels' logarithm of y >= 1, which a library's need not equal in the last bit.
template <class T>
T log_of(T y) {
  using Bits = std::conditional_t<std::is_same_v<T, float>, std::int32_t, std::int64_t>;
  constexpr int kMantissa = std::is_same_v<T, float> ? 23 : 52;
  constexpr Bits kBias = std::is_same_v<T, float> ? 127 : 1023;
  if (!(y < std::numeric_limits<T>::max())) return y;
  const Bits bits = std::bit_cast<Bits>(y);
  T e = static_cast<T>((bits >> kMantissa) - kBias);
  T m = std::bit_cast<T>(
      static_cast<Bits>((bits & ((Bits(1) << kMantissa) - 1)) | (kBias << kMantissa)));
  if (m > T(1.4142135623730951)) {
    m = m / 2;
    e = e + 1;
  }
  const T s = (m - 1) / (m + 1), q = s * s;
  T sum = T(1) / 21;
  for (int odd = 19; odd >= 1; odd -= 2) sum = std::fma(sum, q, T(1) / static_cast<T>(odd));
  return std::fma(e, T(0.69314718055994531), (s + s) * sum);
}

template <class T>
T loss_of(const Inputs<T>& in, T s) {
  const T a = in.loss_scale, square = a * a;
  if (in.loss == static_cast<int>(Loss::huber)) {
    return s > square ? std::fma(std::sqrt(s), a + a, -square) : s;
  }
  if (in.loss == static_cast<int>(Loss::cauchy)) return log_of(T(1) + s / square) * square;
  return s;
}

template <class T>
T loss_weight(const Inputs<T>& in, T s) {
  const T a = in.loss_scale;
  if (in.loss == static_cast<int>(Loss::huber)) {
    return s > a * a ? std::sqrt(a / std::sqrt(s)) : T(1);
  }
  if (in.loss == static_cast<int>(Loss::cauchy)) return std::sqrt(T(1) / (T(1) + s / (a * a)));
  return 1;
}

Layout layout(bool stereo) {
  return layout_of(stereo ? CameraModel::stereo : CameraModel::bal);
}

template <class T>
std::span<const T> camera_of(const Inputs<T>& in, int camera) {
  return in.cameras.subspan(at(camera * kCameraStride), kCameraStride);
}

template <class T>
void store(const Layout& l, const Linearised<T>& j, std::span<T> out) {
  std::fill(out.begin(), out.end(), T(0));
  for (int i = 0; i < 3 * l.residuals; ++i) out[at(i)] = j.jp[i];
  for (int i = 0; i < l.residuals; ++i) {
    out[at(3 * l.residuals + i)] = j.r[i];
    for (int k = 0; k < l.columns(); ++k) out[at(l.jc_at + 8 * i + k)] = j.jc[i * l.dof + k];
    if (l.dof > 8) out[at(l.jc9_at + i)] = j.jc[i * l.dof + 8];
  }
}

}  // namespace

template <class T>
Linearised<T> linearise(const Inputs<T>& in, std::span<const T> camera, int slot) {
  const Layout l = layout(in.stereo);
  Linearised<T> out{};
  const Projection<T> s = project(in, camera, slot, out.r);
  const T weight = in.weights[at(slot)];
  for (int i = 0; i < l.residuals; ++i) out.r[i] *= weight;
  const T robust = loss_weight(in, squared_norm(in, out.r));
  const T w = weight * robust;
  for (int i = 0; i < l.residuals; ++i) out.r[i] *= robust;
  T A[9];
  derivative(in, camera, s, A);
  const auto J = camera.subspan(kRotationAt, 9), scale = camera.subspan(kScalesAt, 6);
  const auto point_scale = in.point_scales.subspan(at(in.slot_points[at(slot)]) * 3, 3);
  for (int i = 0; i < l.residuals; ++i) {
    const T a[3] = {A[3 * i] * w, A[3 * i + 1] * w, A[3 * i + 2] * w};
    const T m[3] = {std::fma(s.q[1], a[2], -(s.q[2] * a[1])),
                    std::fma(s.q[2], a[0], -(s.q[0] * a[2])),
                    std::fma(s.q[0], a[1], -(s.q[1] * a[0]))};  // rotated point x row
    T* row = out.jc + i * l.dof;
    for (int k = 0; k < 3; ++k) {
      row[k] = dot(J[at(k)], J[at(k + 3)], J[at(k + 6)], m[0], m[1], m[2]);
      row[3 + k] = a[k] * scale[at(k)];
      out.jp[3 * i + k] =
          dot(camera[at(k)], camera[at(k + 3)], camera[at(k + 6)], a[0], a[1], a[2]) *
          point_scale[at(k)];
    }
    if (in.stereo) continue;
    const T p = (i == 0 ? s.x : s.y) * w;
    const T fp = (camera[12] * s.square) * p;
    row[6] = (s.factor * p) * scale[3];
    row[7] = fp * scale[4];
    row[8] = (fp * s.square) * scale[5];
  }
  return out;
}

template <class T>
void jacobian_update(const Inputs<T>& in, std::span<T> jacobians, std::span<T> partials) {
  const Layout l = layout(in.stereo);
  for (int chunk = 0; at(chunk * 4) < in.chunks.size(); ++chunk) {
    const auto c = in.chunks.subspan(at(chunk * 4), 4);
    std::array<ChunkSum<T>, 90> sums;
    for (int i = 0; i < c[2]; ++i) {
      const int slot = c[1] + i;
      const Linearised<T> j = linearise(in, camera_of(in, c[0]), slot);
      store(l, j, jacobians.subspan(at(slot) * at(l.jacobian_stride), at(l.jacobian_stride)));
      for (int k = 0; k < l.residuals; ++k) {
        const T* row = j.jc + k * l.dof;
        for (int a = 0; a < l.dof; ++a) {
          for (int b = 0; b < l.dof; ++b) sums[at(a * l.dof + b)].add(i, row[a], row[b]);
          sums[at(l.block() + a)].add(i, row[a], j.r[k]);
        }
      }
    }
    for (int i = 0; i < l.partial(); ++i)
      partials[at(chunk * l.partial() + i)] = sums[at(i)].value();
  }
}

template <class T>
void cost(const Inputs<T>& in, std::span<T> costs) {
  const Layout l = layout(in.stereo);
  for (int chunk = 0; at(chunk * 4) < in.chunks.size(); ++chunk) {
    const auto c = in.chunks.subspan(at(chunk * 4), 4);
    Lanes<T> sum;
    for (int i = 0; i < c[2]; ++i) {
      T r[3];
      project(in, camera_of(in, c[0]), c[1] + i, r);
      for (int k = 0; k < l.residuals; ++k) r[k] *= in.weights[at(c[1] + i)];
      sum.lane[at(i % 8)] += loss_of(in, squared_norm(in, r));
    }
    costs[at(chunk)] = sum.sum();
  }
}

template Linearised<double> linearise(const Inputs<double>&, std::span<const double>, int);
template Linearised<float> linearise(const Inputs<float>&, std::span<const float>, int);
template void jacobian_update(const Inputs<double>&, std::span<double>, std::span<double>);
template void jacobian_update(const Inputs<float>&, std::span<float>, std::span<float>);
template void cost(const Inputs<double>&, std::span<double>);
template void cost(const Inputs<float>&, std::span<float>);

}  // namespace partita::backend::golden
