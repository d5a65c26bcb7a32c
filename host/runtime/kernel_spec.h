// KernelSpec: everything the project knows about one kernel, in one object. The tests, `partita
// verify`, `partita bench`, the packager and the tasks themselves all use the same spec, so none of
// them can drift from the others. A task's folder defines its specs; see host/tasks/*/kernels.h.
#ifndef PARTITA_HOST_RUNTIME_KERNEL_SPEC_H
#define PARTITA_HOST_RUNTIME_KERNEL_SPEC_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "devices/work.h"
#include "host/runtime/shape.h"

namespace partita::runtime {

/// Which text of a kernel: `cpu` blocks for caches with explicit vectors, `gpu` tiles in local
/// memory with many work-items, `fpga` is one work-item that streams.
enum class Variant { cpu, gpu, fpga };
inline constexpr std::array kVariants{Variant::cpu, Variant::gpu, Variant::fpga};
std::string_view to_string(Variant variant);
/// Throws Error for anything but "cpu", "gpu", "fpga".
Variant parse_variant(std::string_view name);

enum class ElementType { u8, i8, u16, i16, u32, i32, u64, f32, f64 };
std::size_t size_of(ElementType type);
std::string_view to_string(ElementType type);

/// How a kernel uses an argument. `local` is a __local array of which only the size is given.
enum class Access { in, out, inout, scalar, local };

struct ArgSpec {
  std::string name;
  Access access = Access::in;
  ElementType type = ElementType::u8;
};

/// An argument's value on the host: an array of `type`, or a scalar as an array of one element.
/// For Access::local it is unused storage of the wanted size.
class HostArray {
 public:
  HostArray() = default;
  HostArray(ElementType type, std::size_t count) : type_(type), bytes_(count * size_of(type)) {}
  template <typename T>
  static HostArray of(ElementType type, std::span<const T> values) {
    HostArray array(type, values.size());
    auto target = array.as<T>();
    for (std::size_t i = 0; i < values.size(); ++i) target[i] = values[i];
    return array;
  }
  template <typename T>
  static HostArray scalar(ElementType type, T value) {
    return of<T>(type, std::span<const T>(&value, 1));
  }
  template <typename T>
  std::span<T> as() {
    return {reinterpret_cast<T*>(bytes_.data()), bytes_.size() / sizeof(T)};
  }
  template <typename T>
  std::span<const T> as() const {
    return {reinterpret_cast<const T*>(bytes_.data()), bytes_.size() / sizeof(T)};
  }
  ElementType type() const { return type_; }
  std::size_t count() const { return bytes_.size() / size_of(type_); }
  std::span<std::byte> bytes() { return bytes_; }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  ElementType type_ = ElementType::u8;
  std::vector<std::byte> bytes_;
};

/// Inputs of one launch for checking: the shape and one value per argument, in argument order.
struct KernelCase {
  Shape shape;
  std::vector<HostArray> args;
};

/// The NDRange of a launch. `global` is divisible by `local` in every dimension.
struct LaunchGeometry {
  std::array<std::size_t, 3> global{1, 1, 1};
  std::array<std::size_t, 3> local{1, 1, 1};
};

/// Largest accepted difference |a - b| <= absolute + relative * |b|; zero for integers: equal.
struct Tolerance {
  double absolute = 0;
  double relative = 0;
};

struct KernelSpec {
  std::string name;    ///< the kernel's function name
  std::string task;    ///< the task's folder below kernels/
  std::string source;  ///< file stem in that folder: SOURCE.gpu.cl, … or SOURCE.cl for all variants
  std::string options;  ///< build options beyond -cl-std=CL1.2, for instance -DRADIUS=3
  std::vector<Variant> variants;
  std::vector<ArgSpec> args;
  /// The NDRange that a variant is launched with for a shape.
  std::function<LaunchGeometry(Variant, const Shape&)> geometry;
  /// __local memory of one work-group of the GPU variant, static arrays and arguments together.
  std::uint64_t gpu_local_bytes = 0;
  /// What that launch costs. `shape` holds counts known when it runs (keypoints, …) as well.
  std::function<Work(Variant, const Shape&)> work;
  /// What the FPGA variant instantiates in hardware; empty design if there is no such variant.
  FpgaDesign design;
  /// Seeded random inputs for a shape; the same seed gives the same bytes.
  std::function<KernelCase(const Shape&, std::uint32_t seed)> make_case;
  /// The golden reference in plain C++: reads the inputs of the case and writes its outputs.
  std::function<void(KernelCase&)> golden;
  Tolerance tolerance;
  /// Shapes for checking: tiny ones first (Oclgrind runs those), odd and extreme ones, full size
  /// last.
  std::vector<Shape> small_shapes;
  std::vector<Shape> shapes;

  bool has(Variant variant) const;
  /// work() with the geometry of the variant filled in: what a launch declares.
  Work declared_work(Variant variant, const Shape& shape) const;
};

/// HostSpec: the same for a step on the host processor (a triangulation, a factorisation).
struct HostSpec {
  std::string name;
  std::string task;
  std::function<Work(const Shape&)> work;
};

}  // namespace partita::runtime

#endif  // PARTITA_HOST_RUNTIME_KERNEL_SPEC_H
