// Specs of fill_gaps, adaptive_mean and median, and the maps that they are checked on.
#include <algorithm>
#include <random>

#include "host/tasks/depth/geometry.h"
#include "host/tasks/depth/kernels.h"
#include "host/tasks/depth/maps.h"
#include "host/tasks/depth/spec_helpers.h"

namespace partita::depth {

runtime::HostArray random_map(Size size, std::uint32_t seed) {
  std::mt19937 random(seed);
  runtime::HostArray map(runtime::ElementType::u16, area(size));
  const auto values = map.as<std::uint16_t>();
  std::size_t i = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x, ++i) {
      const int surface = (x / 23 + y / 31) % 4 * 1500;
      const int noise = static_cast<int>(random() % 120);
      const unsigned kind = random() % 64;  // a grain, a hole at a point, across or downwards
      const bool hole = kind < 4 || (x * 7 + y / 3 * 13) % 41 < 3 || (y * 5 + x / 4 * 11) % 37 < 2;
      const int value =
          kind == 5 ? static_cast<int>(random() % 65536) : 2000 + surface + 20 * x + noise;
      values[i] = static_cast<std::uint16_t>(hole ? 0 : value);
    }
  }
  return map;
}

namespace {

using runtime::Access;
using runtime::ElementType;
using runtime::HostArray;
using runtime::KernelCase;
using runtime::KernelSpec;
using runtime::Shape;
using runtime::Variant;

constexpr std::int64_t kGroup = 64;
constexpr std::int64_t kGroupX = 64;
constexpr std::int64_t kGroupY = 4;
constexpr std::int64_t kSide = 16;

std::int64_t lines_of(const Shape& shape) {
  return shape["vertical"] != 0 ? shape["width"] : shape["height"];
}

// ---- fill_gaps ----------------------------------------------------------------------------------

Work gaps_work(Variant variant, const Shape& shape) {
  const std::uint64_t pixels = pixels_of(shape);
  Work work;
  work.kind = WorkKind::stream;
  work[OpClass::int_add] = 3 * pixels;
  work.read_unique = work.read_issued = 2 * pixels;
  work.written_unique = work.written_issued = 2 * u64(shape["filled"]);
  if (variant == Variant::fpga) {
    work.add_loop(pixels, 1, static_cast<std::uint32_t>(lines_of(shape) * 12));
    work.add_loop(u64(shape["filled"]), 1, static_cast<std::uint32_t>(shape["filled"] / 2 * 4));
  }
  return work;
}

HostArray filled_map(const Shape& shape, HostArray map) {
  golden_fill_gaps(size_of_shape(shape), shape["vertical"] != 0, static_cast<int>(shape["gap"]),
                   shape["extend"] != 0, map.as<std::uint16_t>());
  return map;
}

Shape gaps_shape(std::int64_t width, std::int64_t height, bool vertical, std::int64_t gap,
                 bool extend) {
  return {{"width", width},
          {"height", height},
          {"vertical", vertical},
          {"gap", gap},
          {"extend", extend}};
}

KernelSpec make_gaps() {
  KernelSpec spec = depth_spec("fill_gaps", "gaps");
  spec.args = {{"map", Access::inout, ElementType::u16},
               integer("width"),
               integer("height"),
               integer("vertical"),
               integer("gap"),
               integer("extend")};
  spec.geometry = [](Variant variant, const Shape& shape) {
    const bool vertical = shape["vertical"] != 0;
    if (variant == Variant::gpu) return groups_over(lines_of(shape), 1, kGroup, 1);
    if (variant == Variant::fpga) return single_items(1);
    return single_items(vertical ? ceil_div(shape["width"], kSide) : shape["height"]);
  };
  spec.work = gaps_work;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 12;
  spec.make_case = [](const Shape& shape, std::uint32_t seed) -> KernelCase {
    HostArray map = random_map(size_of_shape(shape), seed);
    const HostArray filled = filled_map(shape, map);
    const auto holes = [](const HostArray& a) {
      const auto values = a.as<std::uint16_t>();
      return std::count(values.begin(), values.end(), std::uint16_t{0});
    };
    return {shape.with("filled", holes(map) - holes(filled)),
            {std::move(map), number(shape["width"]), number(shape["height"]),
             number(shape["vertical"]), number(shape["gap"]), number(shape["extend"])}};
  };
  spec.golden = [](KernelCase& c) {
    golden_fill_gaps(size_of_shape(c.shape), c.shape["vertical"] != 0,
                     static_cast<int>(c.shape["gap"]), c.shape["extend"] != 0,
                     c.args[0].as<std::uint16_t>());
  };
  spec.small_shapes = {gaps_shape(48, 20, false, 3, false), gaps_shape(48, 20, true, 3, true)};
  spec.shapes = {gaps_shape(1, 1, true, 3, true),      gaps_shape(17, 5, true, 0, false),
                 gaps_shape(333, 75, false, 9, true),  gaps_shape(333, 75, true, 5000, true),
                 gaps_shape(333, 75, true, 4, false),  gaps_shape(1280, 720, false, 3, false),
                 gaps_shape(1280, 720, true, 3, false)};
  return spec;
}

// ---- adaptive_mean, median ----------------------------------------------------------------------

/// What the two filters differ in.
struct Filter {
  const char* name;
  std::int64_t reach;
  std::uint64_t operations;  ///< of a pixel
  std::uint64_t multiplications;
  std::uint64_t divisions;
  std::uint64_t loads;  ///< of the CPU variant
  void (*golden)(Size, bool, std::span<const std::uint16_t>, std::span<std::uint16_t>);
};

/// Nine differences, magnitudes, weights and sums; 13 exchanges of two.
constexpr Filter kMean{"adaptive_mean", 4, 9 * 6 + 8, 9 + 1, 1, 10, golden_adaptive_mean};
constexpr Filter kMedian{"median", 3, 13 * 2 + 2, 0, 0, 7, golden_median};

Work filter_work(const Filter& filter, Variant variant, const Shape& shape) {
  const std::uint64_t pixels = pixels_of(shape);
  const bool vertical = shape["vertical"] != 0;
  const std::int64_t length = vertical ? shape["height"] : shape["width"];
  const std::int64_t inner = std::max<std::int64_t>(0, length - 2 * filter.reach);
  const std::uint64_t filtered = pixels / u64(length) * u64(inner);
  const std::uint64_t taps = u64(2 * filter.reach + 1);
  Work work;
  work.kind = WorkKind::stencil;
  work[OpClass::int_add] = filtered * filter.operations;
  work[OpClass::int_mul] = filtered * filter.multiplications;
  work[OpClass::int_special] = filtered * filter.divisions;
  work.read_unique = work.written_unique = work.written_issued = 2 * pixels;
  work.read_issued = 2 * (filtered * taps + pixels - filtered);
  if (variant == Variant::cpu) {  // the last 16 of a row overlap
    const std::uint64_t across = u64(vertical ? shape["width"] : inner);
    const std::uint64_t done = across < 16 ? across : (across + 15) / 16 * 16;
    const std::uint64_t rows = vertical ? u64(inner) : u64(shape["height"]);
    work.read_issued = 2 * (rows * done * filter.loads + pixels - filtered);
    work.written_issued = 2 * (rows * done + pixels - filtered);
  } else if (variant == Variant::fpga) {
    // A row comes in, a row leaves; a division of 20 stages and an adder tree.
    const auto rows = static_cast<std::uint32_t>(shape["height"] + (vertical ? filter.reach : 0));
    work.read_issued = 2 * pixels;
    work.add_loop(u64(rows) * u64(shape["width"]), 1, rows * 6);
    work.add_loop(pixels, 1, static_cast<std::uint32_t>(shape["height"]) * 40);
  }
  return work;
}

KernelSpec make_filter(const Filter& filter) {
  KernelSpec spec = depth_spec(filter.name, "smooth");
  spec.args = {{"map", Access::in, ElementType::u16},
               {"out", Access::out, ElementType::u16},
               integer("width"),
               integer("height"),
               integer("vertical")};
  spec.geometry = [](Variant variant, const Shape& shape) {
    if (variant == Variant::gpu) {
      return groups_over(shape["width"], shape["height"], kGroupX, kGroupY);
    }
    return single_items(variant == Variant::cpu ? ceil_div(shape["height"], kBand) : 1);
  };
  spec.work = [&filter](Variant variant, const Shape& shape) {
    return filter_work(filter, variant, shape);
  };
  const auto taps = static_cast<std::uint32_t>(2 * filter.reach + 1);
  spec.design.buffers[0] = {kFpgaWidth / 16, 16, 16 * taps, 2};
  spec.design.buffer_count = 1;
  const auto count = [&spec](OpClass kind) -> std::uint32_t& {
    return spec.design.operators[static_cast<std::size_t>(kind)];
  };
  count(OpClass::int_add) = static_cast<std::uint32_t>(filter.operations);
  count(OpClass::int_mul) = static_cast<std::uint32_t>(filter.multiplications);
  count(OpClass::int_special) = static_cast<std::uint32_t>(filter.divisions);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) -> KernelCase {
    return {shape,
            {random_map(size_of_shape(shape), seed), HostArray(ElementType::u16, pixels_of(shape)),
             number(shape["width"]), number(shape["height"]), number(shape["vertical"])}};
  };
  spec.golden = [&filter](KernelCase& c) {
    filter.golden(size_of_shape(c.shape), c.shape["vertical"] != 0, c.args[0].as<std::uint16_t>(),
                  c.args[1].as<std::uint16_t>());
  };
  const auto shape_of = [](std::int64_t width, std::int64_t height, bool vertical) {
    return Shape{{"width", width}, {"height", height}, {"vertical", vertical}};
  };
  spec.small_shapes = {shape_of(48, 20, false), shape_of(48, 20, true)};
  for (const bool vertical : {false, true}) {
    for (const auto& [width, height] :
         {std::pair{1, 1}, {8, 11}, {23, 6}, {333, 75}, {1280, 720}}) {
      spec.shapes.push_back(shape_of(width, height, vertical));
    }
  }
  return spec;
}

}  // namespace

const KernelSpec& fill_gaps_spec() {
  static const KernelSpec spec = make_gaps();
  return spec;
}

const KernelSpec& adaptive_mean_spec() {
  static const KernelSpec spec = make_filter(kMean);
  return spec;
}

const KernelSpec& median_spec() {
  static const KernelSpec spec = make_filter(kMedian);
  return spec;
}

}  // namespace partita::depth
