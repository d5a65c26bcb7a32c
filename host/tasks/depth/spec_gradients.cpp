// Specs of sobel and descriptor.
#include <random>

#include "host/tasks/depth/geometry.h"
#include "host/tasks/depth/kernels.h"
#include "host/tasks/depth/spec_helpers.h"

namespace partita::depth {
namespace {

using runtime::Access;
using runtime::ElementType;
using runtime::HostArray;
using runtime::KernelCase;
using runtime::KernelSpec;
using runtime::Shape;
using runtime::Variant;

constexpr std::int64_t kGroupX = 32;
constexpr std::int64_t kGroupY = 8;

runtime::LaunchGeometry geometry(Variant variant, const Shape& shape) {
  switch (variant) {
    case Variant::cpu:
      return single_items(ceil_div(shape["height"], kBand));
    case Variant::gpu:
      return groups_over(shape["width"], shape["height"], kGroupX, kGroupY);
    case Variant::fpga:
      break;
  }
  return single_items(1);
}

std::uint64_t groups(const Shape& shape) {
  return u64(ceil_div(shape["width"], kGroupX) * ceil_div(shape["height"], kGroupY));
}

Work sobel_work(Variant variant, const Shape& shape) {
  const std::uint64_t w = u64(shape["width"]);
  const std::uint64_t h = u64(shape["height"]);
  const std::uint64_t pixels = w * h;
  Work work;
  work.kind = WorkKind::stencil;
  // Per gradient: two doublings, five sums, the shift, the offset, two comparisons.
  work[OpClass::int_add] = 2 * 11 * pixels;
  work.read_unique = pixels;
  work.written_unique = work.written_issued = 2 * pixels;
  switch (variant) {
    case Variant::cpu: {
      if (w < 18) {
        work.read_issued = 8 * pixels;
        break;
      }
      const std::uint64_t steps = (w - 2 + 15) / 16;  // 16 pixels each, the last one overlaps
      work.read_issued = h * (steps * 8 * 16 + 2 * 8);
      work.written_issued = h * (steps * 2 * 16 + 2 * 2);
      break;
    }
    case Variant::gpu:
      work.read_issued = groups(shape) * (kGroupX + 2) * (kGroupY + 2);
      work.local_bytes = work.read_issued + 8 * pixels;
      break;
    case Variant::fpga:
      // One pixel per clock; each row costs one clock more and fills the pipeline anew (load,
      // adder tree, clamp, store: 14 stages); one row more than there are.
      work.read_issued = (h + 1) * w;
      work.add_loop((h + 1) * (w + 1), 1, static_cast<std::uint32_t>((h + 1) * 14));
      break;
  }
  return work;
}

Work descriptor_work(Variant variant, const Shape& shape) {
  const std::uint64_t w = u64(shape["width"]);
  const std::uint64_t h = u64(shape["height"]);
  const std::uint64_t pixels = w * h;
  Work work;  // moves bytes and computes nothing
  work.kind = WorkKind::stencil;
  work.read_unique = 2 * pixels;
  work.written_unique = work.written_issued = 16 * pixels;
  switch (variant) {
    case Variant::cpu: {
      if (w < 18) {
        work.read_issued = 16 * pixels;
        break;
      }
      const std::uint64_t steps = (w - 2 + 15) / 16;
      work.read_issued = h * (steps * 256 + 2 * 16);
      work.written_issued = h * (steps * 256 + 2 * 16);
      break;
    }
    case Variant::gpu:
      work.read_issued =
          groups(shape) * ((kGroupX + 4) * (kGroupY + 4) + (kGroupX + 2) * (kGroupY + 2));
      work.local_bytes = work.read_issued + 16 * pixels;
      break;
    case Variant::fpga:
      // As for sobel, two rows behind; load, window, store: 10 stages.
      work.read_issued = (h + 2) * w * 2;
      work.add_loop((h + 2) * (w + 1), 1, static_cast<std::uint32_t>((h + 2) * 10));
      break;
  }
  return work;
}

HostArray random_picture(const Shape& shape, std::mt19937& random) {
  HostArray picture(ElementType::u8, pixels_of(shape));
  for (std::uint8_t& value : picture.as<std::uint8_t>()) {
    value = static_cast<std::uint8_t>(random());
  }
  return picture;
}

KernelCase sobel_case(const Shape& shape, std::uint32_t seed) {
  std::mt19937 random(seed);
  return {shape,
          {random_picture(shape, random), HostArray(ElementType::u8, pixels_of(shape)),
           HostArray(ElementType::u8, pixels_of(shape)), number(shape["width"]),
           number(shape["height"])}};
}

KernelCase descriptor_case(const Shape& shape, std::uint32_t seed) {
  std::mt19937 random(seed);
  return {shape,
          {random_picture(shape, random), random_picture(shape, random),
           HostArray(ElementType::u8, 16 * pixels_of(shape)), number(shape["width"]),
           number(shape["height"])}};
}

const std::vector<Shape> kSmall = {{{"width", 40}, {"height", 20}}, {{"width", 17}, {"height", 9}}};
const std::vector<Shape> kLarge = {{{"width", 1}, {"height", 1}},
                                   {{"width", 2}, {"height", 3}},
                                   {{"width", 18}, {"height", 17}},
                                   {{"width", 333}, {"height", 75}},
                                   {{"width", 1280}, {"height", 720}}};

KernelSpec make_sobel() {
  KernelSpec spec = depth_spec("sobel", "gradients");
  spec.args = {{"image", Access::in, ElementType::u8},
               {"du", Access::out, ElementType::u8},
               {"dv", Access::out, ElementType::u8},
               integer("width"),
               integer("height")};
  spec.geometry = geometry;
  spec.work = sobel_work;
  spec.gpu_local_bytes = (kGroupX + 2) * (kGroupY + 2);
  spec.design.buffers[0] = {kFpgaWidth, 8, 2, 2};
  spec.design.buffer_count = 1;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 22;
  spec.design.operand_bits = 12;
  spec.make_case = sobel_case;
  spec.golden = [](KernelCase& c) {
    golden_sobel(size_of_shape(c.shape), c.args[0].as<std::uint8_t>(), c.args[1].as<std::uint8_t>(),
                 c.args[2].as<std::uint8_t>());
  };
  spec.small_shapes = kSmall;
  spec.shapes = kLarge;
  return spec;
}

KernelSpec make_descriptor() {
  KernelSpec spec = depth_spec("descriptor", "gradients");
  spec.args = {{"du", Access::in, ElementType::u8},
               {"dv", Access::in, ElementType::u8},
               {"descriptors", Access::out, ElementType::u8},
               integer("width"),
               integer("height")};
  spec.geometry = geometry;
  spec.work = descriptor_work;
  spec.gpu_local_bytes = (kGroupX + 4) * (kGroupY + 4) + (kGroupX + 2) * (kGroupY + 2);
  spec.design.buffers[0] = {kFpgaWidth, 8, 7, 2};
  spec.design.buffer_count = 1;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] =
      8;  // selects of the first row
  spec.design.operand_bits = 8;
  spec.design.memory_ports = 2;
  spec.make_case = descriptor_case;
  spec.golden = [](KernelCase& c) {
    golden_descriptor(size_of_shape(c.shape), c.args[0].as<std::uint8_t>(),
                      c.args[1].as<std::uint8_t>(), c.args[2].as<std::uint8_t>());
  };
  spec.small_shapes = kSmall;
  spec.shapes = kLarge;
  return spec;
}

}  // namespace

const KernelSpec& sobel_spec() {
  static const KernelSpec spec = make_sobel();
  return spec;
}

const KernelSpec& descriptor_spec() {
  static const KernelSpec spec = make_descriptor();
  return spec;
}

}  // namespace partita::depth
