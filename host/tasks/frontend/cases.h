// Seeded inputs for checking the front-end's kernels, and conversions of kernel arguments.
#ifndef PARTITA_HOST_TASKS_FRONTEND_CASES_H
#define PARTITA_HOST_TASKS_FRONTEND_CASES_H

#include <cstdint>
#include <span>
#include <vector>

#include "host/runtime/kernel_spec.h"
#include "host/tasks/frontend/golden.h"
#include "host/tasks/frontend/layout.h"
#include "host/tasks/sensing/frame.h"

namespace partita::frontend {

using sensing::GrayImage;

/// The same numbers on every machine (an xorshift generator).
class Random {
 public:
  explicit Random(std::uint32_t seed) : state_(seed * 2654435769u + 88172645u) {}
  std::uint32_t next() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 17;
    state_ ^= state_ << 5;
    return state_;
  }
  /// Uniform in least..most.
  int between(int least, int most) {
    return least + static_cast<int>(next() % static_cast<std::uint32_t>(most - least + 1));
  }

 private:
  std::uint32_t state_;
};

/// Blocks of random grey with noise: corners everywhere, and flat places.
GrayImage textured_image(Size size, std::uint32_t seed);
/// The image moved by (dx, dy), edges repeated.
GrayImage moved_image(const GrayImage& image, int dx, int dy);

/// Random features of both levels' grids, cell by cell, as compact makes them.
golden::FeatureList random_features(Size image, const Grid& grid0, const Grid& grid1,
                                    Random& random);
std::vector<golden::Descriptor> random_descriptors(std::size_t count, Random& random);

// ---- Arguments of a KernelCase
// -------------------------------------------------------------------

runtime::HostArray bytes_of(const GrayImage& image);
runtime::HostArray scalar(int value);
GrayImage image_of(const runtime::HostArray& array, Size size);

/// An array argument of 32-bit elements from records that consist of them; at least one element, as
/// no buffer is empty.
template <typename Record>
runtime::HostArray array_of(std::span<const Record> records, runtime::ElementType type) {
  constexpr std::size_t kWords = sizeof(Record) / 4;
  runtime::HostArray array(type, std::max<std::size_t>(1, records.size() * kWords));
  std::copy_n(reinterpret_cast<const std::byte*>(records.data()), records.size_bytes(),
              array.bytes().begin());
  return array;
}

/// The first `count` records of an array argument.
template <typename Record>
std::span<const Record> records_of(const runtime::HostArray& array, std::size_t count) {
  return {reinterpret_cast<const Record*>(array.bytes().data()), count};
}

template <typename Record>
void assign_records(runtime::HostArray& array, std::span<const Record> records) {
  std::copy_n(reinterpret_cast<const std::byte*>(records.data()), records.size_bytes(),
              array.bytes().begin());
}

/// width and height of a shape.
Size size_of(const runtime::Shape& shape);

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_CASES_H
