#include "host/tasks/sensing/scenario_math.h"

#include <initializer_list>

namespace partita::sensing::scenario {

namespace {

constexpr double kPi = 3.14159265358979323846;

}  // namespace

double sine(double x) {
  const double turns = std::floor(x / kPi + 0.5);  // x = turns * pi + r, |r| <= pi/2
  const double r = x - turns * kPi;
  const double s = r * r;
  double sum = -1.0 / 121645100408832000.0;  // Taylor's series up to r^19, by Horner
  sum = sum * s + 1.0 / 355687428096000.0;
  sum = sum * s - 1.0 / 1307674368000.0;
  sum = sum * s + 1.0 / 6227020800.0;
  sum = sum * s - 1.0 / 39916800.0;
  sum = sum * s + 1.0 / 362880.0;
  sum = sum * s - 1.0 / 5040.0;
  sum = sum * s + 1.0 / 120.0;
  sum = sum * s - 1.0 / 6.0;
  sum = sum * s + 1.0;
  const bool odd = turns - 2.0 * std::floor(turns * 0.5) != 0.0;
  return odd ? -(sum * r) : sum * r;
}

double cosine(double x) {
  return sine(x + kPi / 2);
}

std::uint64_t hash(std::uint64_t seed, std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  std::uint64_t state = seed;
  for (const std::uint64_t value : {a, b, c}) {
    state = (state ^ value) + 0x9e3779b97f4a7c15ULL;
    state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9ULL;
    state = (state ^ (state >> 27)) * 0x94d049bb133111ebULL;
    state ^= state >> 31;
  }
  return state;
}

double uniform(std::uint64_t seed, std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  return static_cast<double>(hash(seed, a, b, c) >> 11) * 0x1p-53;
}

double normal(std::uint64_t seed, std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  const std::uint64_t base = hash(seed, a, b, c);
  double sum = -6.0;
  for (std::uint64_t i = 0; i < 12; ++i) sum += uniform(base, i);
  return sum;
}

}  // namespace partita::sensing::scenario
