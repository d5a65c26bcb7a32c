// Small conveniences that the detection kernels' specs share.
#ifndef PARTITA_HOST_TASKS_DETECTION_SPEC_HELPERS_H
#define PARTITA_HOST_TASKS_DETECTION_SPEC_HELPERS_H

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "host/io/darknet.h"
#include "host/runtime/kernel_spec.h"
#include "host/tasks/detection/tensor.h"

namespace partita::detection {

inline constexpr std::uint64_t kFloat = sizeof(float);

inline std::uint64_t u64(std::int64_t value) {
  return static_cast<std::uint64_t>(value);
}

inline std::uint64_t ceil_div(std::uint64_t a, std::uint64_t b) {
  return (a + b - 1) / b;
}

inline int entry(const runtime::Shape& shape, std::string_view name) {
  return static_cast<int>(shape[name]);
}

inline runtime::KernelSpec detection_spec(std::string name, std::string source) {
  runtime::KernelSpec spec;
  spec.name = std::move(name);
  spec.task = "detection";
  spec.source = std::move(source);
  spec.variants = {runtime::kVariants.begin(), runtime::kVariants.end()};
  return spec;
}

inline runtime::ArgSpec floats(std::string name, runtime::Access access) {
  return {std::move(name), access, runtime::ElementType::f32};
}

inline void add_integers(runtime::KernelSpec& spec, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    spec.args.push_back({name, runtime::Access::scalar, runtime::ElementType::i32});
  }
}

inline void add_view(runtime::KernelSpec& spec, const std::string& name) {
  for (const char* part : {"_offset", "_row", "_pixel"}) {
    spec.args.push_back({name + part, runtime::Access::scalar, runtime::ElementType::i32});
  }
}

/// Arguments of a case, in order.
class CaseArgs {
 public:
  explicit CaseArgs(std::uint32_t seed) : random_(seed) {}

  /// `count` numbers from -1 to 1.
  void numbers(std::size_t count) {
    runtime::HostArray array(runtime::ElementType::f32, count);
    for (float& x : array.as<float>()) {
      x = static_cast<float>(static_cast<std::int32_t>(random_())) * 0x1p-31F;
    }
    args_.push_back(std::move(array));
  }
  void integer(std::int64_t value) {
    args_.push_back(
        runtime::HostArray::scalar(runtime::ElementType::i32, static_cast<std::int32_t>(value)));
  }
  void real(float value) {
    args_.push_back(runtime::HostArray::scalar(runtime::ElementType::f32, value));
  }
  void view(const TensorView& v) {
    for (const std::int32_t value : {v.offset, v.row, v.pixel}) integer(value);
  }
  std::vector<runtime::HostArray> take() { return std::move(args_); }

 private:
  std::mt19937 random_;
  std::vector<runtime::HostArray> args_;
};

inline ActivationCode activation_code(io::darknet::Activation activation) {
  using io::darknet::Activation;
  const float slope = activation == Activation::leaky  ? 0.1F
                      : activation == Activation::relu ? 0.0F
                                                       : 1.0F;
  return {slope, static_cast<std::int32_t>(activation)};
}

inline ActivationCode activation_of(const runtime::Shape& shape) {
  return activation_code(static_cast<io::darknet::Activation>(shape["activation"]));
}

/// Channels that a case's maps have beside those that matter, some before and some after.
inline constexpr int kFirstChannel = 3, kOtherChannels = 5;

/// Numbers of a border around the result.
inline std::uint64_t border_numbers(const runtime::Shape& shape, std::uint64_t channels) {
  const std::uint64_t border = u64(shape["border"]);
  return 2 * border * (u64(shape["width"] + shape["height"]) + 2 * border) * channels;
}

/// Operations of an activation, one number.
inline void add_activation(Work& work, std::uint64_t numbers, const runtime::Shape& shape) {
  using io::darknet::Activation;
  // exp: ten fma, a subtraction, a multiplication; a reciprocal: eight fma. See activation.clh.
  switch (static_cast<Activation>(shape["activation"])) {
    case Activation::relu6:
      work[OpClass::float_add] += 2 * numbers;
      break;
    case Activation::logistic:
    case Activation::swish:
      work[OpClass::float_fma] += 18 * numbers;
      work[OpClass::float_add] += 2 * numbers;
      work[OpClass::float_mul] += 2 * numbers;
      break;
    case Activation::mish:
      work[OpClass::float_fma] += 18 * numbers;
      work[OpClass::float_add] += 3 * numbers;
      work[OpClass::float_mul] += 4 * numbers;
      break;
    default:
      work[OpClass::float_add] += numbers;
      work[OpClass::float_mul] += numbers;
  }
}

inline bool is_curve(const runtime::Shape& shape) {
  return shape["activation"] >= static_cast<int>(io::darknet::Activation::relu6);
}

/// FPGA: results leave one a clock; curves, on three multiply-add units, one every six before.
inline void add_result_loops(Work& work, std::uint64_t results, const runtime::Shape& shape) {
  if (is_curve(shape)) work.add_loop(results, 6, 100);
  work.add_loop(results, 1, 40);
}

/// What those take.
inline void add_result_operators(FpgaDesign& design) {
  design.operators[static_cast<std::size_t>(OpClass::float_fma)] += 3;
  design.operators[static_cast<std::size_t>(OpClass::float_mul)] += 2;
  design.operators[static_cast<std::size_t>(OpClass::float_add)] += 3;
}

/// One work-item per number in groups of 64 on the GPU, one per row on the CPU.
inline runtime::LaunchGeometry map_geometry(runtime::Variant variant, std::uint64_t height,
                                            std::uint64_t numbers) {
  if (variant == runtime::Variant::fpga) return {};
  if (variant == runtime::Variant::cpu) return {{height, 1, 1}, {1, 1, 1}};
  return {{ceil_div(numbers, 64) * 64, 1, 1}, {64, 1, 1}};
}

inline std::uint64_t numbers_of(const runtime::Shape& shape, std::string_view channels) {
  return u64(shape["width"] * shape["height"] * shape[channels]);
}

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_SPEC_HELPERS_H
