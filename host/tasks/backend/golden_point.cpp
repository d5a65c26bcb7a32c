// Golden references of what happens point by point, and of the Schur complement.
#include "host/tasks/backend/golden.h"
#include "host/tasks/backend/golden_tools.h"

namespace partita::backend::golden {
namespace {

Layout layout(bool stereo) {
  return layout_of(stereo ? CameraModel::stereo : CameraModel::bal);
}

template <class T>
T damping(T diagonal, T inverse_radius) {
  return std::min(std::max(diagonal, T(1e-6)), T(1e32)) * inverse_radius;
}

/// L of V + D with its diagonal inverted, and y = inverse(L) b: 1/l00, l10, l20, 1/l11, l21, 1/l22,
/// y. A pivot is not below its D, whatever rounding does.
template <class T>
std::array<T, 9> factorise(std::span<const T> V, T inverse_radius) {
  const T d0 = damping(V[0], inverse_radius), d1 = damping(V[3], inverse_radius),
          d2 = damping(V[5], inverse_radius);
  const T i0 = T(1) / std::sqrt(V[0] + d0), l10 = V[1] * i0, l20 = V[2] * i0;
  const T i1 = T(1) / std::sqrt(std::max(std::fma(-l10, l10, V[3] + d1), d1));
  const T l21 = std::fma(-l20, l10, V[4]) * i1;
  const T i2 = T(1) / std::sqrt(std::max(std::fma(-l21, l21, std::fma(-l20, l20, V[5] + d2)), d2));
  const T y0 = V[6] * i0, y1 = std::fma(-l10, y0, V[7]) * i1,
          y2 = std::fma(-l21, y1, std::fma(-l20, y0, V[8])) * i2;
  return {i0, l10, l20, i1, l21, i2, y0, y1, y2};
}

/// Column c of row k of Z' in its record.
int column_at(int k, int c) {
  return c < 8 ? 8 * k + c : 24 + k;
}

template <class T>
std::array<T, 3> column(std::span<const T> record, int c) {
  return {record[at(column_at(0, c))], record[at(column_at(1, c))], record[at(column_at(2, c))]};
}

}  // namespace

template <class T>
void point_update(const Inputs<T>& in, std::span<T> blocks, std::span<T> gradients) {
  const Layout l = layout(in.stereo);
  std::fill(gradients.begin(), gradients.end(), T(0));
  constexpr int kPairs[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  for (int point = 0; point < in.points; ++point) {
    const auto block = blocks.subspan(at(point * kPointBlock), kPointBlock);
    std::fill(block.begin(), block.end(), T(0));
    for (int i = in.point_start[at(point)]; i < in.point_start[at(point) + 1]; ++i) {
      const auto record = in.jacobians.subspan(at(in.point_slots[at(i)]) * at(l.jacobian_stride));
      for (int k = 0; k < l.residuals; ++k) {
        const auto row = record.subspan(at(3 * k), 3);
        for (std::size_t e = 0; e < 6; ++e) {
          block[e] = std::fma(row[at(kPairs[e][0])], row[at(kPairs[e][1])], block[e]);
        }
        for (std::size_t e = 0; e < 3; ++e) {
          block[6 + e] = std::fma(row[e], record[at(3 * l.residuals + k)], block[6 + e]);
        }
      }
    }
    T& largest = gradients[at(point / kGroupPoints)];
    for (int k = 0; k < 3; ++k) {
      largest = std::max(largest, std::abs(block[at(6 + k)]) / in.point_scales[at(point * 3 + k)]);
    }
  }
}

template <class T>
void eliminate_points(const Inputs<T>& in, std::span<T> factors, std::span<T> eliminated) {
  const Layout l = layout(in.stereo);
  for (int point = 0; point < in.points; ++point) {
    const auto f = factorise(in.blocks.subspan(at(point * kPointBlock), 9), in.inverse_radius);
    std::copy(f.begin(), f.end(), factors.begin() + point * kPointBlock);
    for (int i = in.point_start[at(point)]; i < in.point_start[at(point) + 1]; ++i) {
      const int slot = in.point_slots[at(i)];
      const auto record = in.jacobians.subspan(at(slot) * at(l.jacobian_stride));
      const auto out = eliminated.subspan(at(slot * kEliminatedStride), kEliminatedStride);
      std::fill(out.begin(), out.end(), T(0));
      for (int r = 0; r < l.residuals; ++r) {
        const auto jp = record.subspan(at(3 * r), 3);
        T A[3];  // Jp inverse(L)'
        A[0] = jp[0] * f[0];
        A[1] = std::fma(-A[0], f[1], jp[1]) * f[3];
        A[2] = std::fma(-A[1], f[4], std::fma(-A[0], f[2], jp[2])) * f[5];
        for (int k = 0; k < 3; ++k) {
          for (int c = 0; c < l.dof; ++c) {
            const T jc = c < 8 ? record[at(l.jc_at + 8 * r + c)] : record[at(l.jc9_at + r)];
            out[at(column_at(k, c))] = std::fma(jc, A[k], out[at(column_at(k, c))]);
          }
        }
      }
      std::copy(f.begin() + 6, f.end(), out.begin() + 27);
    }
  }
}

template <class T>
void schur_complement(const Inputs<T>& in, std::span<T> blocks, std::span<T> camera_sums) {
  const Layout l = layout(in.stereo);
  const auto record = [&](int slot) {
    return in.eliminated.subspan(at(slot * kEliminatedStride), kEliminatedStride);
  };
  for (int pair = 0; at(pair * 4) < in.pairs.size(); ++pair) {
    const auto p = in.pairs.subspan(at(pair * 4), 4);
    const bool diagonal = p[2] == p[3];
    std::array<RunningSum<T>, 81> S;
    std::array<RunningSum<T>, 9> rhs;
    const auto sums = camera_sums.subspan(at(p[2] * 3 * l.dof), at(3 * l.dof));
    if (diagonal) {
      for (int chunk = in.camera_chunks[at(p[2])]; chunk < in.camera_chunks[at(p[2]) + 1];
           ++chunk) {
        const auto part = in.partials.subspan(at(chunk * l.partial()), at(l.partial()));
        for (int i = 0; i < l.block(); ++i) S[at(i)].add(part[at(i)]);
        for (int i = 0; i < l.dof; ++i) rhs[at(i)].add(-part[at(l.block() + i)]);
      }
      for (int i = 0; i < l.dof; ++i) {
        sums[at(l.dof + i)] = -rhs[at(i)].value();
        sums[at(2 * l.dof + i)] = S[at(i * l.dof + i)].value();
      }
    }
    for (int e = p[0]; e < p[1]; ++e) {
      const int i = in.entries[at(2 * e)], j = in.entries[at(2 * e + 1)];
      for (int r = 0; r < l.dof; ++r) {
        for (int c = 0; c < l.dof; ++c) {
          S[at(r * l.dof + c)].add_product(-1, column(record(i), r), column(record(j), c));
        }
        if (diagonal && i == j) {
          const auto y = record(i).subspan(27, 3);
          rhs[at(r)].add_product(1, column(record(i), r), {y[0], y[1], y[2]});
        }
      }
    }
    for (int i = 0; i < l.block(); ++i) blocks[at(pair * l.block() + i)] = S[at(i)].value();
    for (int i = 0; diagonal && i < l.dof; ++i) sums[at(i)] = rhs[at(i)].value();
  }
}

template <class T>
void back_substitute(const Inputs<T>& in, std::span<T> to, std::span<T> sums) {
  std::fill(sums.begin(), sums.end(), T(0));
  constexpr int kDiagonal[3] = {0, 3, 5};
  for (int point = 0; point < in.points; ++point) {
    std::array<Lanes<T>, 3> lanes;
    T t[3] = {0, 0, 0};
    for (int i = in.point_start[at(point)]; i < in.point_start[at(point) + 1]; ++i) {
      const auto z = in.eliminated.subspan(at(in.point_slots[at(i)] * kEliminatedStride));
      const auto step = in.steps.subspan(at(in.point_cameras[at(i)] * kStepStride), 9);
      for (int k = 0; k < 3; ++k) {
        for (int c = 0; c < 8; ++c) {
          T& lane = lanes[at(k)].lane[at(c)];
          lane = std::fma(z[at(8 * k + c)], step[at(c)], lane);
        }
        t[k] = std::fma(z[at(24 + k)], step[8], t[k]);
      }
    }
    for (int k = 0; k < 3; ++k) t[k] = lanes[at(k)].sum() + t[k];
    const auto f = in.factors.subspan(at(point * kPointBlock), 9);
    const auto block = in.blocks.subspan(at(point * kPointBlock), 9);
    T d[3];  // inverse(L)' (-y - t)
    d[2] = (-f[8] - t[2]) * f[5];
    d[1] = std::fma(-f[4], d[2], -f[7] - t[1]) * f[3];
    d[0] = std::fma(-f[2], d[2], std::fma(-f[1], d[1], -f[6] - t[0])) * f[0];
    const auto total = sums.subspan(at(point / kGroupPoints * 3), 3);
    for (int k = 0; k < 3; ++k) {
      const T x = in.state[at(point * 3 + k)], step = d[k] * in.point_scales[at(point * 3 + k)];
      to[at(point * 3 + k)] = x + step;
      const T damped = damping(block[at(kDiagonal[k])], in.inverse_radius);
      total[0] = std::fma(std::fma(damped, d[k], -block[at(6 + k)]), d[k], total[0]);
      total[1] = std::fma(step, step, total[1]);
      total[2] = std::fma(x, x, total[2]);
    }
  }
}

template void point_update(const Inputs<double>&, std::span<double>, std::span<double>);
template void point_update(const Inputs<float>&, std::span<float>, std::span<float>);
template void eliminate_points(const Inputs<double>&, std::span<double>, std::span<double>);
template void eliminate_points(const Inputs<float>&, std::span<float>, std::span<float>);
template void schur_complement(const Inputs<double>&, std::span<double>, std::span<double>);
template void schur_complement(const Inputs<float>&, std::span<float>, std::span<float>);
template void back_substitute(const Inputs<double>&, std::span<double>, std::span<double>);
template void back_substitute(const Inputs<float>&, std::span<float>, std::span<float>);

}  // namespace partita::backend::golden
