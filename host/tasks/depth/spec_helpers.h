// Small conveniences that the depth kernels' specs share.
#ifndef PARTITA_HOST_TASKS_DEPTH_SPEC_HELPERS_H
#define PARTITA_HOST_TASKS_DEPTH_SPEC_HELPERS_H

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "host/runtime/kernel_spec.h"
#include "host/tasks/depth/golden.h"

namespace partita::depth {

/// Integer operations of the distance of two descriptors: 16 differences, magnitudes, 15 sums.
inline constexpr std::uint64_t kDistanceOps = 47;

inline std::uint64_t u64(std::int64_t value) {
  return static_cast<std::uint64_t>(value);
}

inline runtime::KernelSpec depth_spec(std::string name, std::string source) {
  runtime::KernelSpec spec;
  spec.name = std::move(name);
  spec.task = "depth";
  spec.source = std::move(source);
  spec.variants = {runtime::kVariants.begin(), runtime::kVariants.end()};
  return spec;
}

inline runtime::ArgSpec integer(std::string name) {
  return {std::move(name), runtime::Access::scalar, runtime::ElementType::i32};
}

inline runtime::HostArray number(std::int64_t value) {
  return runtime::HostArray::scalar(runtime::ElementType::i32, static_cast<std::int32_t>(value));
}

inline Size size_of_shape(const runtime::Shape& shape) {
  return {static_cast<int>(shape["width"]), static_cast<int>(shape["height"])};
}

inline std::size_t pixels_of(const runtime::Shape& shape) {
  return static_cast<std::size_t>(shape["width"] * shape["height"]);
}

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_SPEC_HELPERS_H
