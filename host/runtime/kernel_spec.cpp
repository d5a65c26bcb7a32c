#include "host/runtime/kernel_spec.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::runtime {

std::string_view to_string(Variant variant) {
  switch (variant) {
    case Variant::cpu:
      return "cpu";
    case Variant::gpu:
      return "gpu";
    case Variant::fpga:
      return "fpga";
  }
  return "?";
}

Variant parse_variant(std::string_view name) {
  for (const Variant variant : kVariants) {
    if (to_string(variant) == name) return variant;
  }
  throw Error(fmt::format("'{}' is not a variant: expected cpu, gpu or fpga", name));
}

std::size_t size_of(ElementType type) {
  switch (type) {
    case ElementType::u8:
    case ElementType::i8:
      return 1;
    case ElementType::u16:
    case ElementType::i16:
      return 2;
    case ElementType::u32:
    case ElementType::i32:
    case ElementType::f32:
      return 4;
    case ElementType::u64:
    case ElementType::f64:
      return 8;
  }
  return 1;
}

std::string_view to_string(ElementType type) {
  switch (type) {
    case ElementType::u8:
      return "uchar";
    case ElementType::i8:
      return "char";
    case ElementType::u16:
      return "ushort";
    case ElementType::i16:
      return "short";
    case ElementType::u32:
      return "uint";
    case ElementType::i32:
      return "int";
    case ElementType::f32:
      return "float";
    case ElementType::f64:
      return "double";
    case ElementType::u64:
      return "ulong";
  }
  return "?";
}

bool KernelSpec::has(Variant variant) const {
  return std::find(variants.begin(), variants.end(), variant) != variants.end();
}

Work KernelSpec::declared_work(Variant variant, const Shape& shape) const {
  Work declared = work(variant, shape);
  const LaunchGeometry launch = geometry(variant, shape);
  declared.groups = 1;
  declared.group_items = 1;
  for (std::size_t i = 0; i < launch.global.size(); ++i) {
    declared.groups *= launch.global[i] / launch.local[i];
    declared.group_items *= launch.local[i];
  }
  declared.group_local_bytes = variant == Variant::gpu ? gpu_local_bytes : 0;
  return declared;
}

}  // namespace partita::runtime
