// Specs of segments, join_segments and remove_speckles.
#include <algorithm>
#include <random>

#include "host/tasks/depth/geometry.h"
#include "host/tasks/depth/kernels.h"
#include "host/tasks/depth/maps.h"
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

constexpr std::int64_t kGroup = 64;
constexpr std::int64_t kJoiners = 256;
constexpr int kSimilarity = 256;  // of the cases, 1/256 px

const std::vector<Shape> kSmall = {{{"width", 48}, {"height", 33}}};
const std::vector<Shape> kLarge = {{{"width", 1}, {"height", 1}},
                                   {{"width", 1}, {"height", 50}},
                                   {{"width", 333}, {"height", 16}},
                                   {{"width", 333}, {"height", 75}},
                                   {{"width", 1280}, {"height", 720}}};

std::uint32_t rows_of(const Shape& shape) {
  return static_cast<std::uint32_t>(shape["height"]);
}

// ---- segments -----------------------------------------------------------------------------------

Work segments_work(Variant variant, const Shape& shape) {
  const std::uint64_t pixels = pixels_of(shape);
  Work work;
  work.kind = variant == Variant::gpu ? WorkKind::gather : WorkKind::serial;
  // Two comparisons of neighbours, the label, its root's label, the sum.
  work[OpClass::int_add] = pixels * 16;
  work.read_unique = work.read_issued = 2 * pixels;
  work.written_unique = work.written_issued = 8 * pixels;
  if (variant == Variant::cpu) {
    // Both passes in memory, the row above as well; roots where runs meet; then labels, their
    // labels and a size to count up.
    work.read_issued = 15 * pixels;
    work.written_issued = 16 * pixels;
  } else if (variant == Variant::gpu) {
    // Three passes; in the second the neighbours as well, and roots by atomic reads: two pairs of
    // roots of about two steps, two minima; in the third one more root, a minimum and a sum.
    work.read_issued = 2 * (5 * pixels - u64(shape["width"]) - u64(shape["height"]));
    work[OpClass::atomic] = 12 * pixels;
    work[OpClass::int_special] = pixels;
  } else if (variant == Variant::fpga) {
    const auto bands = static_cast<std::uint32_t>(ceil_div(shape["height"], kBand));
    // Runs meet at one pixel in eight: a root is found in two dependent reads on the chip, then two
    // writes that the next pixel has to see. Afterwards a read, a dependent one and a sum: 2.
    work.add_loop(pixels, 1, rows_of(shape) * 10);
    work.add_loop(pixels / 8, 6, 10);
    work.add_loop(pixels, 2, bands * 10);
    work.add_loop(pixels, 1, bands * 10);
  }
  return work;
}

KernelSpec make_segments() {
  KernelSpec spec = depth_spec("segments", "segments");
  spec.args = {{"map", Access::in, ElementType::u16},
               {"labels", Access::out, ElementType::i32},
               {"sizes", Access::out, ElementType::i32},
               integer("width"),
               integer("height"),
               integer("similarity")};
  spec.geometry = [](Variant variant, const Shape& shape) {
    const std::int64_t bands = ceil_div(shape["height"], kBand);
    if (variant == Variant::gpu) return groups_over(bands * kGroup, 1, kGroup, 1);
    return single_items(variant == Variant::cpu ? bands : 1);
  };
  spec.work = segments_work;
  spec.design.buffers[0] = {u64(kFpgaWidth), 16, 1, 2};
  spec.design.buffers[1] = {u64(kBand * kFpgaWidth), 16, 2, 2};
  spec.design.buffer_count = 2;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 24;
  spec.design.operand_bits = 32;
  spec.design.memory_ports = 2;
  spec.make_case = [](const Shape& shape, std::uint32_t seed) -> KernelCase {
    return {shape,
            {random_map(size_of_shape(shape), seed), HostArray(ElementType::i32, pixels_of(shape)),
             HostArray(ElementType::i32, pixels_of(shape)), number(shape["width"]),
             number(shape["height"]), number(kSimilarity)}};
  };
  spec.golden = [](KernelCase& c) {
    golden_segments(size_of_shape(c.shape), c.args[0].as<std::uint16_t>(), kSimilarity,
                    c.args[1].as<std::int32_t>(), c.args[2].as<std::int32_t>());
  };
  spec.small_shapes = kSmall;
  spec.shapes = kLarge;
  return spec;
}

// ---- join_segments ------------------------------------------------------------------------------

Work join_work(Variant variant, const Shape& shape) {
  const std::uint64_t borders = u64((shape["height"] - 1) / kBand);
  const std::uint64_t pixels = borders * u64(shape["width"]);
  Work work;
  work.kind = variant == Variant::gpu ? WorkKind::gather : WorkKind::serial;
  work[OpClass::int_add] = pixels * 20;
  work.read_unique = pixels * 12;
  work.read_issued = pixels * 4;
  work.written_unique = pixels * 8;
  if (variant == Variant::gpu) {
    work[OpClass::atomic] = pixels * 13;
    return work;
  }
  // Both rows twice, a label for each pixel; where runs begin (one pixel in eight) roots of one or
  // two steps and their sizes.
  work.read_issued = pixels * 19;
  work.written_issued = pixels * 9;
  if (variant == Variant::fpga) {
    // There chains of two to three dependent reads from the memory, 60 clocks each.
    work.add_loop(3 * pixels, 1, static_cast<std::uint32_t>(borders * 3 * 10));
    work.add_loop(pixels / 8, 120, 200);
    work.add_loop(pixels / 4, 180, 200);
  }
  return work;
}

KernelSpec make_join() {
  KernelSpec spec = depth_spec("join_segments", "segments");
  spec.args = {{"map", Access::in, ElementType::u16},
               {"labels", Access::inout, ElementType::i32},
               {"sizes", Access::inout, ElementType::i32},
               integer("width"),
               integer("height"),
               integer("similarity")};
  spec.geometry = [](Variant variant, const Shape&) {
    return variant == Variant::gpu ? groups_over(kJoiners, 1, kJoiners, 1) : single_items(1);
  };
  spec.work = join_work;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 16;
  spec.design.operand_bits = 32;
  spec.design.memory_ports = 3;
  spec.make_case = [](const Shape& shape, std::uint32_t seed) -> KernelCase {
    HostArray map = random_map(size_of_shape(shape), seed);
    HostArray labels(ElementType::i32, pixels_of(shape));
    HostArray sizes(ElementType::i32, pixels_of(shape));
    golden_segments(size_of_shape(shape), map.as<std::uint16_t>(), kSimilarity,
                    labels.as<std::int32_t>(), sizes.as<std::int32_t>());
    return {shape,
            {std::move(map), std::move(labels), std::move(sizes), number(shape["width"]),
             number(shape["height"]), number(kSimilarity)}};
  };
  spec.golden = [](KernelCase& c) {
    golden_join_segments(size_of_shape(c.shape), c.args[0].as<std::uint16_t>(), kSimilarity,
                         c.args[1].as<std::int32_t>(), c.args[2].as<std::int32_t>());
  };
  spec.small_shapes = kSmall;
  spec.shapes = kLarge;
  return spec;
}

// ---- remove_speckles ----------------------------------------------------------------------------

Work speckles_work(Variant variant, const Shape& shape) {
  const std::uint64_t pixels = pixels_of(shape);
  Work work;
  work.kind = WorkKind::gather;
  work[OpClass::int_add] = 4 * pixels;
  work.read_unique = 6 * pixels;
  work.read_issued = 14 * pixels;
  work.written_unique = work.written_issued = 2 * pixels;
  if (variant == Variant::fpga) {
    // Two dependent reads of single words, in flight together: the memory takes one in two clocks.
    work.add_loop(pixels, 4, rows_of(shape) * 140);
  }
  return work;
}

KernelSpec make_speckles() {
  KernelSpec spec = depth_spec("remove_speckles", "speckles");
  spec.args = {{"map", Access::inout, ElementType::u16},
               {"labels", Access::in, ElementType::i32},
               {"sizes", Access::in, ElementType::i32},
               integer("width"),
               integer("height"),
               integer("least")};
  spec.geometry = [](Variant variant, const Shape& shape) {
    if (variant == Variant::gpu) {
      return groups_over(shape["width"] * shape["height"], 1, kGroup, 1);
    }
    return single_items(variant == Variant::cpu ? ceil_div(shape["height"], kBand) : 1);
  };
  spec.work = speckles_work;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 6;
  spec.design.operand_bits = 32;
  spec.design.memory_ports = 3;
  spec.make_case = [](const Shape& shape, std::uint32_t seed) -> KernelCase {
    const Size size = size_of_shape(shape);
    HostArray map = random_map(size, seed);
    HostArray labels(ElementType::i32, pixels_of(shape));
    HostArray sizes(ElementType::i32, pixels_of(shape));
    golden_segments(size, map.as<std::uint16_t>(), kSimilarity, labels.as<std::int32_t>(),
                    sizes.as<std::int32_t>());
    golden_join_segments(size, map.as<std::uint16_t>(), kSimilarity, labels.as<std::int32_t>(),
                         sizes.as<std::int32_t>());
    return {shape,
            {std::move(map), std::move(labels), std::move(sizes), number(shape["width"]),
             number(shape["height"]), number(40)}};
  };
  spec.golden = [](KernelCase& c) {
    golden_remove_speckles(c.args[1].as<std::int32_t>(), c.args[2].as<std::int32_t>(), 40,
                           c.args[0].as<std::uint16_t>());
  };
  spec.small_shapes = kSmall;
  spec.shapes = kLarge;
  return spec;
}

}  // namespace

const KernelSpec& segments_spec() {
  static const KernelSpec spec = make_segments();
  return spec;
}

const KernelSpec& join_segments_spec() {
  static const KernelSpec spec = make_join();
  return spec;
}

const KernelSpec& remove_speckles_spec() {
  static const KernelSpec spec = make_speckles();
  return spec;
}

}  // namespace partita::depth
