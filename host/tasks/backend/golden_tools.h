// Sums in the kernels' order, and small matrices by index.
#ifndef PARTITA_HOST_TASKS_BACKEND_GOLDEN_TOOLS_H
#define PARTITA_HOST_TASKS_BACKEND_GOLDEN_TOOLS_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>

namespace partita::backend::golden {

inline std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

/// Eight lanes, one term after the other into the next; added in a tree.
template <class T>
struct Lanes {
  std::array<T, 8> lane{};
  T sum() const {
    return ((lane[0] + lane[4]) + (lane[2] + lane[6])) +
           ((lane[1] + lane[5]) + (lane[3] + lane[7]));
  }
};

inline constexpr float kFixedOne = 1099511627776.0f;
inline constexpr float kFixedLargest = 1152921504606846976.0f;

inline std::int64_t to_fixed(float value) {
  const float bounded = std::min(std::max(value * kFixedOne, -kFixedLargest), kFixedLargest);
  return static_cast<std::int64_t>(std::nearbyint(bounded));
}
inline float from_fixed(std::int64_t value) {
  return static_cast<float>(value) * (1.0f / kFixedOne);
}

/// The sum over a chunk of products: lanes of doubles, or fixed point.
template <class T>
class ChunkSum {
 public:
  void add(int index, T a, T b) {
    if constexpr (std::is_same_v<T, float>) {
      fixed_ += to_fixed(a * b);
    } else {
      lanes_.lane[at(index % 8)] = std::fma(a, b, lanes_.lane[at(index % 8)]);
    }
  }
  T value() const {
    if constexpr (std::is_same_v<T, float>) {
      return from_fixed(fixed_);
    } else {
      return lanes_.sum();
    }
  }

 private:
  Lanes<T> lanes_;
  std::int64_t fixed_ = 0;
};

/// A running sum of terms and of products of three: chained in doubles, or fixed point.
template <class T>
class RunningSum {
 public:
  void add(T term) {
    if constexpr (std::is_same_v<T, float>) {
      fixed_ += to_fixed(term);
    } else {
      sum_ += term;
    }
  }
  /// += sign (a . b)
  void add_product(T sign, std::array<T, 3> a, std::array<T, 3> b) {
    if constexpr (std::is_same_v<T, float>) {
      const std::int64_t term = to_fixed(std::fma(a[2], b[2], std::fma(a[1], b[1], a[0] * b[0])));
      fixed_ += sign > 0 ? term : -term;
    } else {
      for (std::size_t k = 0; k < 3; ++k) sum_ = std::fma(sign * a[k], b[k], sum_);
    }
  }
  T value() const {
    if constexpr (std::is_same_v<T, float>) {
      return from_fixed(fixed_);
    } else {
      return sum_;
    }
  }

 private:
  T sum_ = 0;
  std::int64_t fixed_ = 0;
};

}  // namespace partita::backend::golden

#endif  // PARTITA_HOST_TASKS_BACKEND_GOLDEN_TOOLS_H
