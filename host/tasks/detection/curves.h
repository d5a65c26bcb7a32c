// exp and the logistic function out of fma alone, as kernels/detection/activation.clh has them: the
// same bits on every machine, a few units in the last place from the true values.
#ifndef PARTITA_HOST_TASKS_DETECTION_CURVES_H
#define PARTITA_HOST_TASKS_DETECTION_CURVES_H

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace partita::detection {

/// e^x for x from -80 to 80.
inline float exp_80(float x) {
  const float shifted = std::fma(x, 1.44269504F, 12582912.0F);
  const float n = shifted - 12582912.0F;
  float r = std::fma(n, -0.693359375F, x);
  r = std::fma(n, 2.12194440e-4F, r);
  float p = std::fma(r, 1.98412698e-4F, 1.38888889e-3F);
  for (const float c : {8.33333333e-3F, 4.16666667e-2F, 1.66666667e-1F, 0.5F, 1.0F, 1.0F}) {
    p = std::fma(r, p, c);
  }
  return p * std::bit_cast<float>((std::bit_cast<std::int32_t>(shifted) - 0x4B400000 + 127) << 23);
}

/// 1 / d for positive d.
inline float reciprocal(float d) {
  float r = std::bit_cast<float>(0x7EF311C7 - std::bit_cast<std::int32_t>(d));
  for (int i = 0; i < 4; ++i) r = std::fma(r, std::fma(-d, r, 1.0F), r);
  return r;
}

inline float logistic(float x) {
  return reciprocal(1.0F + exp_80(std::clamp(-x, -80.0F, 80.0F)));
}

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_CURVES_H
