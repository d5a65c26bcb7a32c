#include "host/tasks/frontend/pattern.h"

#include <cmath>
#include <numbers>

#include "host/tasks/frontend/layout.h"

namespace partita::frontend {
namespace {

constexpr int kLargestRadius = 14;

/// splitmix64: the pattern is part of the descriptor's definition, so its generator is ours.
class Generator {
 public:
  std::uint32_t next() {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return static_cast<std::uint32_t>((z ^ (z >> 31)) >> 32);
  }
  /// About normal with deviation 6.2 (a fifth of the patch, as BRIEF has it): twelve uniform
  /// numbers of 0..65535 have a deviation of 65536.
  int normal() {
    std::int64_t sum = -6 * 65536;
    for (int i = 0; i < 12; ++i) sum += next() >> 16;
    const std::int64_t scaled = sum * 62 / 10;
    return static_cast<int>((scaled + (scaled >= 0 ? 32768 : -32768)) / 65536);
  }

 private:
  std::uint64_t state_ = 20261122;
};

bool inside(int x, int y) {
  return x * x + y * y <= kLargestRadius * kLargestRadius;
}

std::array<TestPair, kTests> make_pattern() {
  Generator generator;
  std::array<TestPair, kTests> pattern{};
  for (TestPair& pair : pattern) {
    do {
      pair = {generator.normal(), generator.normal(), generator.normal(), generator.normal()};
    } while (!inside(pair.x0, pair.y0) || !inside(pair.x1, pair.y1) ||
             (pair.x0 == pair.x1 && pair.y0 == pair.y1));
  }
  return pattern;
}

/// Turns by an angle given as cosine and sine in 1/4096 and rounds; returns the patch offset.
std::uint16_t turned(int x, int y, int cosine, int sine) {
  const auto rounded = [](int v) { return (v + (v >= 0 ? 2048 : -2048)) / 4096; };
  const int tx = rounded(x * cosine - y * sine);
  const int ty = rounded(x * sine + y * cosine);
  return static_cast<std::uint16_t>((ty + kPatchRadius) * kPatchStride + tx + kPatchRadius);
}

std::vector<std::uint16_t> make_table() {
  std::vector<std::uint16_t> table;
  table.reserve(std::size_t{kBins} * kTests * 2);
  for (int bin = 0; bin < kBins; ++bin) {
    const double angle = 2 * std::numbers::pi * (bin + 0.5) / kBins;
    const int cosine = static_cast<int>(std::lround(4096 * std::cos(angle)));
    const int sine = static_cast<int>(std::lround(4096 * std::sin(angle)));
    for (const TestPair& pair : base_pattern()) {
      table.push_back(turned(pair.x0, pair.y0, cosine, sine));
      table.push_back(turned(pair.x1, pair.y1, cosine, sine));
    }
  }
  return table;
}

}  // namespace

const std::array<TestPair, kTests>& base_pattern() {
  static const std::array<TestPair, kTests> pattern = make_pattern();
  return pattern;
}

const std::vector<std::uint16_t>& test_table() {
  static const std::vector<std::uint16_t> table = make_table();
  return table;
}

}  // namespace partita::frontend
