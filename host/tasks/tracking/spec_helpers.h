// Small conveniences that the tracking kernels' specs share.
#ifndef PARTITA_HOST_TASKS_TRACKING_SPEC_HELPERS_H
#define PARTITA_HOST_TASKS_TRACKING_SPEC_HELPERS_H

#include <algorithm>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <string>
#include <utility>

#include "host/runtime/kernel_spec.h"
#include "host/tasks/tracking/golden.h"

namespace partita::tracking {

inline constexpr std::uint64_t kFloat = 4;
inline constexpr std::uint64_t kMaxCells = 32;
inline constexpr std::uint64_t kMaxPlane = kMaxCells * kMaxCells;
inline constexpr std::uint64_t kPlaneItems = 128;  ///< of a GPU's work-group on a plane
inline constexpr std::uint64_t kTile = 8;          ///< cells across, of a GPU's work-group

inline std::uint64_t count_of(const runtime::Shape& shape, const char* name) {
  return static_cast<std::uint64_t>(shape[name]);
}
inline std::uint64_t plane_of(const runtime::Shape& shape) {
  return count_of(shape, "cells") * count_of(shape, "cells");
}
inline std::uint64_t stages_of(const runtime::Shape& shape) {
  return static_cast<std::uint64_t>(std::bit_width(count_of(shape, "cells")) - 1);
}

inline runtime::LaunchGeometry items(std::uint64_t x, std::uint64_t y = 1) {
  return {{x, y, 1}, {1, 1, 1}};
}
inline runtime::LaunchGeometry groups(std::uint64_t count, std::uint64_t size) {
  return {{count * size, 1, 1}, {size, 1, 1}};
}

inline runtime::KernelSpec tracking_spec(std::string name) {
  runtime::KernelSpec spec;
  spec.source = name;
  spec.name = std::move(name);
  spec.task = "tracking";
  spec.variants = {runtime::kVariants.begin(), runtime::kVariants.end()};
  return spec;
}

inline runtime::ArgSpec floats(std::string name, runtime::Access access = runtime::Access::in) {
  return {std::move(name), access, runtime::ElementType::f32};
}
inline runtime::ArgSpec integer(std::string name) {
  return {std::move(name), runtime::Access::scalar, runtime::ElementType::i32};
}
inline runtime::HostArray number(std::int64_t value) {
  return runtime::HostArray::scalar(runtime::ElementType::i32, static_cast<std::int32_t>(value));
}
inline runtime::HostArray real(float value) {
  return runtime::HostArray::scalar(runtime::ElementType::f32, value);
}
inline runtime::HostArray random_floats(std::size_t count, float low, float high,
                                        std::mt19937& random) {
  runtime::HostArray array(runtime::ElementType::f32, count);
  for (float& value : array.as<float>()) {
    value = low + (high - low) * static_cast<float>(random() >> 8) / 16777216.0f;
  }
  return array;
}

inline FpgaDesign design(std::initializer_list<OnChipBuffer> buffers,
                         std::initializer_list<std::pair<OpClass, std::uint32_t>> operators,
                         std::uint32_t operand_bits, std::uint32_t memory_ports) {
  FpgaDesign result;
  for (const OnChipBuffer& buffer : buffers) result.buffers[result.buffer_count++] = buffer;
  for (const auto& [op, n] : operators) result.operators[static_cast<std::size_t>(op)] = n;
  result.operand_bits = operand_bits;
  result.memory_ports = memory_ports;
  return result;
}

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_SPEC_HELPERS_H
