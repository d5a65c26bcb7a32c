// Functions that the golden references and the kernels (kernels/tracking/math.clh) compute by the
// same steps, each rounded as IEEE 754 says, so that they agree on every device.
#ifndef PARTITA_HOST_TASKS_TRACKING_GOLDEN_MATH_H
#define PARTITA_HOST_TASKS_TRACKING_GOLDEN_MATH_H

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace partita::tracking {

inline std::size_t plane_size(int cells) {
  return static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells);
}

/// 1 / sqrt(v) for normal v > 0: a guess from the bits, three steps of Newton's method.
inline float reciprocal_root(float v) {
  float r = std::bit_cast<float>(0x5F375A86u - (std::bit_cast<std::uint32_t>(v) >> 1));
  const float half = 0.5f * v;
  for (int i = 0; i < 3; ++i) {
    const float square = r * r;
    r = r * std::fma(-half, square, 1.5f);
  }
  return r;
}

/// 1 / v for v from 2^-100 to 2^100: likewise, four steps.
inline float reciprocal(float v) {
  float r = std::bit_cast<float>(0x7EF311C7u - std::bit_cast<std::uint32_t>(v));
  for (int i = 0; i < 4; ++i) r = std::fma(r, std::fma(-v, r, 1.0f), r);
  return r;
}

/// exp(-v) for v >= 0 (from 40 on as for 40): the power of two, times a polynomial of the rest.
inline float exp_of_minus(float v) {
  const float x = v < 40.0f ? v : 40.0f;
  const auto n = static_cast<std::int32_t>(std::fma(x, 1.44269504f, 0.5f));
  const auto whole = static_cast<float>(n);
  // r = n ln 2 - x in [-0.35, 0.35], ln 2 in two parts.
  const float r = std::fma(whole, -2.12194440e-4f, std::fma(whole, 0.693359375f, -x));
  float p = 1.0f / 720.0f;
  p = std::fma(p, r, 1.0f / 120.0f);
  p = std::fma(p, r, 1.0f / 24.0f);
  p = std::fma(p, r, 1.0f / 6.0f);
  p = std::fma(p, r, 0.5f);
  p = std::fma(p, r, 1.0f);
  p = std::fma(p, r, 1.0f);
  return p * std::bit_cast<float>(static_cast<std::uint32_t>(127 - n) << 23);
}

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_GOLDEN_MATH_H
