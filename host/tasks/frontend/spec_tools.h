// Small helpers for writing KernelSpecs.
#ifndef PARTITA_HOST_TASKS_FRONTEND_SPEC_TOOLS_H
#define PARTITA_HOST_TASKS_FRONTEND_SPEC_TOOLS_H

#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include "devices/work.h"
#include "host/runtime/kernel_spec.h"
#include "host/tasks/frontend/layout.h"

namespace partita::frontend {

inline const std::vector<runtime::Variant> kAllVariants{
    runtime::Variant::cpu, runtime::Variant::gpu, runtime::Variant::fpga};

inline std::uint64_t divide_up(std::int64_t value, std::int64_t step) {
  return static_cast<std::uint64_t>((value + step - 1) / step);
}
inline std::uint64_t round_up(std::int64_t value, std::int64_t step) {
  return divide_up(value, step) * static_cast<std::uint64_t>(step);
}
inline std::uint64_t pixels(Size size) {
  return static_cast<std::uint64_t>(size.pixels());
}

inline FpgaDesign design(std::initializer_list<OnChipBuffer> buffers,
                         std::initializer_list<std::pair<OpClass, std::uint32_t>> operators,
                         std::uint32_t operand_bits, std::uint32_t memory_ports) {
  FpgaDesign result;
  for (const OnChipBuffer& buffer : buffers) result.buffers[result.buffer_count++] = buffer;
  for (const auto& [op, count] : operators) result.operators[static_cast<std::size_t>(op)] = count;
  result.operand_bits = operand_bits;
  result.memory_ports = memory_ports;
  return result;
}

/// Geometry of kernels with 32 work-items per feature on the GPU (four features per group), and a
/// work-item per `per_item` features on the CPU.
inline runtime::LaunchGeometry feature_geometry(runtime::Variant variant, std::int64_t count,
                                                std::int64_t per_item) {
  switch (variant) {
    case runtime::Variant::gpu:
      return {{32, round_up(count, 4), 1}, {32, 4, 1}};
    case runtime::Variant::cpu:
      return {{divide_up(count, per_item), 1, 1}, {1, 1, 1}};
    case runtime::Variant::fpga:
      return {};
  }
  return {};
}

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_SPEC_TOOLS_H
