// Arithmetic of the built-in scenario. Only IEEE operations that every machine rounds alike (+ - *
// / and square root), no library function whose last digit differs from one libm to the next, and
// sums in a written order: so that a seed gives the same bytes everywhere.
#ifndef PARTITA_HOST_TASKS_SENSING_SCENARIO_MATH_H
#define PARTITA_HOST_TASKS_SENSING_SCENARIO_MATH_H

#include <cmath>
#include <cstdint>

namespace partita::sensing::scenario {

struct Vec3 {
  double x = 0;
  double y = 0;
  double z = 0;
};
inline Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator*(Vec3 a, double s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) {
  return std::sqrt(dot(a, a));
}
inline Vec3 unit(Vec3 a) {
  return a * (1.0 / length(a));
}

/// Columns are the images of the axes: v -> x * v.x + y * v.y + z * v.z.
struct Rotation {
  Vec3 x{1, 0, 0};
  Vec3 y{0, 1, 0};
  Vec3 z{0, 0, 1};
};
inline Vec3 rotate(const Rotation& R, Vec3 v) {
  return R.x * v.x + R.y * v.y + R.z * v.z;
}
inline Vec3 rotate_back(const Rotation& R, Vec3 v) {
  return {dot(R.x, v), dot(R.y, v), dot(R.z, v)};
}

/// Sine and cosine to about 1e-15 * (1 + |x|), for |x| < 1e6.
double sine(double x);
double cosine(double x);

/// SplitMix64's finaliser over the arguments: independent random bits for every combination.
std::uint64_t hash(std::uint64_t seed, std::uint64_t a, std::uint64_t b = 0, std::uint64_t c = 0);

/// Uniform in [0, 1), from the hash of the arguments.
double uniform(std::uint64_t seed, std::uint64_t a, std::uint64_t b = 0, std::uint64_t c = 0);

/// Close to normal with mean 0 and standard deviation 1 (a sum of twelve uniforms).
double normal(std::uint64_t seed, std::uint64_t a, std::uint64_t b, std::uint64_t c);

/// A signed index as a hash argument.
inline std::uint64_t key(std::int64_t i) {
  return static_cast<std::uint64_t>(i);
}

}  // namespace partita::sensing::scenario

#endif  // PARTITA_HOST_TASKS_SENSING_SCENARIO_MATH_H
