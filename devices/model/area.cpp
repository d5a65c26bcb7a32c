#include "devices/model/area.h"

#include <algorithm>
#include <bit>

namespace partita::model {
namespace {

using profile::Area;

/// What one operator of a class costs. Floating point: UG973/PG060, Xilinx Floating-Point Operator
/// v7.1, UltraScale+, medium DSP usage, single precision; special functions are the mean of divide
/// and square root in logic. Integers grow with the operand's width and are built below.
struct OperatorCost {
  std::uint64_t lut, ff, dsp;
};
constexpr OperatorCost kFloatAdd{220, 330, 2};
constexpr OperatorCost kFloatMul{80, 150, 3};
constexpr OperatorCost kFloatFma{300, 480, 5};
constexpr OperatorCost kFloatSpecial{800, 1400, 0};
constexpr OperatorCost kDoubleAdd{700, 1000, 3};
constexpr OperatorCost kDoubleMul{200, 500, 11};
constexpr OperatorCost kDoubleFma{900, 1500, 14};
constexpr OperatorCost kDoubleSpecial{3300, 6000, 0};

// An AXI master with its burst buffers; the control slave, loop control and FSM of a kernel. Order
// of magnitude of Vitis HLS reports (UG1399) for small kernels.
constexpr Area kPort{900, 1400, 2, 0, 0};
constexpr Area kKernel{1500, 2200, 0, 0, 0};

/// DSP48E2 multiplies 27 x 18 (UG579); wider ones are tiled. Below 5 bits LUTs do.
std::uint64_t multiplier_dsps(std::uint64_t bits) {
  if (bits <= 4) return 0;
  return ((bits + 26) / 27) * ((bits + 17) / 18);
}

Area operator_area(OpClass c, std::uint64_t bits) {
  const auto of = [](OperatorCost o) { return Area{o.lut, o.ff, 0, 0, o.dsp}; };
  switch (c) {
    case OpClass::int_add:
      return {bits, bits, 0, 0, 0};  // one LUT and register a bit (CARRY8)
    case OpClass::int_mul: {
      const std::uint64_t dsps = multiplier_dsps(bits);
      return {std::max<std::uint64_t>(bits * std::min<std::uint64_t>(bits, 4), 2 * bits), 3 * bits, 0,
              0, dsps};
    }
    case OpClass::int_special:
      return {2 * bits * 3, 2 * bits * 3, 0, 0, 0};
    case OpClass::float_add:
      return of(kFloatAdd);
    case OpClass::float_mul:
      return of(kFloatMul);
    case OpClass::float_fma:
      return of(kFloatFma);
    case OpClass::float_special:
      return of(kFloatSpecial);
    case OpClass::double_add:
      return of(kDoubleAdd);
    case OpClass::double_mul:
      return of(kDoubleMul);
    case OpClass::double_fma:
      return of(kDoubleFma);
    case OpClass::double_special:
      return of(kDoubleSpecial);
    case OpClass::atomic:
      return {4 * bits, 4 * bits, 0, 0, 0};
    case OpClass::count_:
      break;
  }
  return {};
}

/// RAMB36 blocks of one bank of depth x width, by its shapes (UG573): 512x72, 1Kx36, 2Kx18, 4Kx9,
/// 8Kx4, 16Kx2, 32Kx1. The shape that needs the fewest is taken. RAMB18 halves are not shared.
std::uint64_t bank_blocks(std::uint64_t depth, std::uint64_t width) {
  constexpr std::uint64_t kShapes[][2] = {{512, 72}, {1024, 36}, {2048, 18}, {4096, 9},
                                          {8192, 4}, {16384, 2}, {32768, 1}};
  std::uint64_t best = ~std::uint64_t{0};
  for (const auto& [rows, bits] : kShapes) {
    best = std::min(best, ((depth + rows - 1) / rows) * ((width + bits - 1) / bits));
  }
  return best;
}

/// Memory below this many bits a bank becomes LUTs (RAM32M: 64 bits a LUT), as Vitis HLS does.
constexpr std::uint64_t kDistributedBits = 1024;

Area buffer_area(const OnChipBuffer& buffer) {
  if (buffer.depth == 0 || buffer.width_bits == 0) return {};
  const std::uint64_t depth = std::min<std::uint64_t>(buffer.depth, 1u << 30);
  const std::uint64_t banks = std::max(1u, buffer.banks);
  const std::uint64_t copies = (std::max(2u, buffer.ports) + 1) / 2;  // a BRAM has two ports
  const std::uint64_t bits = depth * buffer.width_bits;
  const std::uint64_t all = banks * copies;
  // Registers and multiplexers of the port, also where LUTs hold the data.
  const Area around{all * 8, all * buffer.width_bits, 0, 0, 0};
  if (bits <= kDistributedBits) return around + Area{all * ((bits + 63) / 64) * 2, 0, 0, 0, 0};
  // 32 LUTs to address and select a block memory: as many as the largest memory made of LUTs has.
  return around + Area{all * 32, 0, all * bank_blocks(depth, buffer.width_bits), 0, 0};
}

Area times(const Area& a, std::uint64_t n) {
  return {a.lut * n, a.ff * n, a.bram36 * n, a.uram * n, a.dsp * n};
}

}  // namespace

Area operator+(const Area& a, const Area& b) {
  return {a.lut + b.lut, a.ff + b.ff, a.bram36 + b.bram36, a.uram + b.uram, a.dsp + b.dsp};
}

Area estimate_area(const FpgaDesign& design) {
  Area unit = kKernel + times(kPort, std::max(1u, design.memory_ports));
  const std::uint64_t bits = std::clamp(design.operand_bits, 1u, 64u);
  for (std::size_t i = 0; i < kOpClasses; ++i) {
    unit = unit + times(operator_area(static_cast<OpClass>(i), bits), design.operators[i]);
  }
  const std::size_t buffers = std::min<std::size_t>(design.buffer_count, kMaxBuffers);
  for (std::size_t i = 0; i < buffers; ++i) unit = unit + buffer_area(design.buffers[i]);
  return times(unit, std::max(1u, design.compute_units));
}

std::string misfit(const Area& area, const profile::DeviceProfile& device) {
  const Area& has = device.fabric.area;
  const auto over = [&](const char* name, std::uint64_t needs, std::uint64_t available) {
    return needs <= available ? std::string()
                              : "device '" + device.id + "': " + std::to_string(needs) + " " +
                                    name + ", expected at most " + std::to_string(available);
  };
  for (const std::string& line :
       {over("LUT", area.lut, has.lut), over("FF", area.ff, has.ff),
        over("BRAM36", area.bram36, has.bram36), over("URAM", area.uram, has.uram),
        over("DSP", area.dsp, has.dsp)}) {
    if (!line.empty()) return line;
  }
  return "";
}

}  // namespace partita::model
