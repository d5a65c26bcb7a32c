// Specs of support_plausible, support_redundant and support_list.
#include <algorithm>

#include "host/tasks/depth/geometry.h"
#include "host/tasks/depth/kernels.h"
#include "host/tasks/depth/spec_helpers.h"
#include "host/tasks/depth/synthetic.h"

namespace partita::depth {
namespace {

using runtime::Access;
using runtime::ElementType;
using runtime::HostArray;
using runtime::KernelCase;
using runtime::KernelSpec;
using runtime::Shape;
using runtime::Variant;

constexpr std::int64_t kSide = 16;
constexpr std::int64_t kLines = 64;
constexpr std::int64_t kListers = 256;
constexpr int kStep = 5;  // of the grids in the cases

Size grid_of(const Shape& shape) {
  return {static_cast<int>(shape["columns"]), static_cast<int>(shape["rows"])};
}

std::uint64_t points_in(const Shape& shape) {
  return u64(shape["columns"] * shape["rows"]);
}

HostArray random_grid(const Shape& shape, std::uint32_t seed) {
  const Size grid = grid_of(shape);
  const auto values =
      synthetic_grid({grid.width * kStep, grid.height * kStep}, kStep, 127, 40, seed);
  return HostArray::of<std::int16_t>(ElementType::i16, values);
}

/// Σ over positions of the window's places inside 0..length-1.
std::uint64_t window_sum(std::int64_t length, std::int64_t window) {
  std::uint64_t sum = 0;
  for (std::int64_t i = 0; i < length; ++i) {
    sum += u64(std::min(i + window, length - 1) - std::max(i - window, std::int64_t{0}) + 1);
  }
  return sum;
}

// ---- support_plausible --------------------------------------------------------------------------

runtime::LaunchGeometry plausible_geometry(Variant variant, const Shape& shape) {
  switch (variant) {
    case Variant::cpu:
      return single_items(shape["rows"]);
    case Variant::gpu:
      return groups_over(shape["columns"], shape["rows"], kSide, kSide);
    case Variant::fpga:
      break;
  }
  return single_items(1);
}

/// Σ over the groups along one axis of their tile's places inside the grid.
std::uint64_t tile_sum(std::int64_t length, std::int64_t window) {
  std::uint64_t sum = 0;
  for (std::int64_t start = 0; start < length; start += kSide) {
    sum +=
        u64(std::min(start + kSide + window, length) - std::max(start - window, std::int64_t{0}));
  }
  return sum;
}

/// Elements that the CPU variant loads along a row, for one row of the window.
std::uint64_t cpu_window_loads(std::int64_t columns, std::int64_t window) {
  std::uint64_t loads = 0;
  for (std::int64_t i = 0; i < columns;) {
    if (i >= window && i + 15 + window < columns) {
      loads += u64((2 * window + 1) * 16);
      i += 16;
    } else {
      loads += u64(std::min(i + window, columns - 1) - std::max(i - window, std::int64_t{0}) + 1);
      ++i;
    }
  }
  return loads;
}

Work plausible_work(Variant variant, const Shape& shape) {
  const std::int64_t columns = shape["columns"];
  const std::int64_t rows = shape["rows"];
  const std::int64_t window = shape["window"];
  const std::uint64_t points = points_in(shape);
  constexpr std::uint64_t kOps = 6;  // two comparisons, max, min, difference, sum
  Work work;
  work.kind = WorkKind::stencil;
  work.read_unique = work.written_unique = work.written_issued = 2 * points;
  const std::uint64_t inside = window_sum(columns, window) * window_sum(rows, window);
  switch (variant) {
    case Variant::cpu:
      work[OpClass::int_add] = kOps * inside + 2 * points;
      work.read_issued =
          2 * (cpu_window_loads(columns, window) * window_sum(rows, window) + 2 * points);
      break;
    case Variant::gpu: {
      const std::uint64_t places = u64((2 * window + 1) * (2 * window + 1));
      work[OpClass::int_add] = points * (kOps * places + 2);
      work.read_issued = 2 * tile_sum(columns, window) * tile_sum(rows, window);
      work.local_bytes = 2 * points * (places + 1) + work.read_issued;
      break;
    }
    case Variant::fpga: {
      const std::uint64_t taps = window_sum(columns, window) * u64(rows);
      work[OpClass::int_add] = kOps * taps * u64(2 * window + 1) + 2 * points;
      work.read_issued = 2 * points;
      // Filling the line buffers, then one column of the window per clock: its rows lie in banks
      // of their own. 8 stages each time a point begins.
      work.add_loop(u64((rows + 2 * window) * columns), 1, static_cast<std::uint32_t>(rows * 6));
      work.add_loop(taps, 1, static_cast<std::uint32_t>(points * 8));
      break;
    }
  }
  return work;
}

KernelSpec make_plausible() {
  KernelSpec spec = depth_spec("support_plausible", "support_grid");
  spec.args = {{"grid", Access::in, ElementType::i16},
               {"out", Access::out, ElementType::i16},
               integer("columns"),
               integer("rows"),
               integer("window"),
               integer("threshold"),
               integer("least")};
  spec.geometry = plausible_geometry;
  spec.work = plausible_work;
  spec.gpu_local_bytes = 2 * (kSide + 2 * kLargestWindow) * (kSide + 2 * kLargestWindow);
  spec.design.buffers[0] = {kFpgaColumns, 16, 2 * kLargestWindow + 1, 2};
  spec.design.buffer_count = 1;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 6 * (2 * kLargestWindow + 1);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) -> KernelCase {
    return {shape,
            {random_grid(shape, seed), HostArray(ElementType::i16, points_in(shape)),
             number(shape["columns"]), number(shape["rows"]), number(shape["window"]), number(5),
             number(5)}};
  };
  spec.golden = [](KernelCase& c) {
    golden_support_plausible(grid_of(c.shape), c.args[0].as<std::int16_t>(),
                             static_cast<int>(c.shape["window"]), 5, 5,
                             c.args[1].as<std::int16_t>());
  };
  spec.small_shapes = {{{"columns", 20}, {"rows", 9}, {"window", 2}}};
  spec.shapes = {{{"columns", 1}, {"rows", 1}, {"window", 5}},
                 {{"columns", 33}, {"rows", 50}, {"window", 16}},
                 {{"columns", 256}, {"rows", 144}, {"window", 5}}};
  return spec;
}

// ---- support_redundant --------------------------------------------------------------------------

runtime::LaunchGeometry redundant_geometry(Variant variant, const Shape& shape) {
  const std::int64_t lines = shape["vertical"] != 0 ? shape["columns"] : shape["rows"];
  switch (variant) {
    case Variant::cpu:
      return single_items(lines);
    case Variant::gpu:
      return groups_over(lines, 1, kLines, 1);
    case Variant::fpga:
      break;
  }
  return single_items(1);
}

Work redundant_work(Variant variant, const Shape& shape) {
  const std::uint64_t points = points_in(shape);
  const std::int64_t length = shape["vertical"] != 0 ? shape["rows"] : shape["columns"];
  const std::uint64_t lines = points / u64(length);
  const std::uint64_t visits = window_sum(length, shape["reach"]) * lines;  // itself included
  Work work;
  work.kind = WorkKind::gather;
  work[OpClass::int_add] = (visits - points) * 6 + points;
  work.read_unique = work.written_unique = 2 * points;
  work.read_issued = 2 * visits;
  work.written_issued = 2 * points;
  if (variant == Variant::fpga) {
    // One pair of neighbours per clock; a point has to be decided (10 stages) before the next.
    work.add_loop(points * u64(shape["reach"]), 1, static_cast<std::uint32_t>(points * 10));
  }
  return work;
}

KernelSpec make_redundant() {
  KernelSpec spec = depth_spec("support_redundant", "support_grid");
  spec.args = {{"grid", Access::inout, ElementType::i16},
               integer("columns"),
               integer("rows"),
               integer("vertical"),
               integer("reach"),
               integer("threshold")};
  spec.geometry = redundant_geometry;
  spec.work = redundant_work;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 12;
  spec.make_case = [](const Shape& shape, std::uint32_t seed) -> KernelCase {
    return {shape,
            {random_grid(shape, seed), number(shape["columns"]), number(shape["rows"]),
             number(shape["vertical"]), number(shape["reach"]), number(1)}};
  };
  spec.golden = [](KernelCase& c) {
    golden_support_redundant(grid_of(c.shape), c.shape["vertical"] != 0,
                             static_cast<int>(c.shape["reach"]), 1, c.args[0].as<std::int16_t>());
  };
  spec.small_shapes = {{{"columns", 20}, {"rows", 9}, {"vertical", 0}, {"reach", 5}},
                       {{"columns", 20}, {"rows", 9}, {"vertical", 1}, {"reach", 5}}};
  spec.shapes = {{{"columns", 1}, {"rows", 1}, {"vertical", 0}, {"reach", 5}},
                 {{"columns", 70}, {"rows", 80}, {"vertical", 1}, {"reach", 16}},
                 {{"columns", 256}, {"rows", 144}, {"vertical", 0}, {"reach", 5}},
                 {{"columns", 256}, {"rows", 144}, {"vertical", 1}, {"reach", 5}}};
  return spec;
}

// ---- support_list -------------------------------------------------------------------------------

Work list_work(Variant variant, const Shape& shape) {
  const std::uint64_t points = points_in(shape);
  Work work;
  work.kind = WorkKind::reduce;
  work[OpClass::int_add] = 2 * points;
  work.read_unique = work.read_issued = 2 * points;
  work.written_unique = work.written_issued = 8 * u64(shape["points"]) + 4;
  if (variant == Variant::gpu) {
    work[OpClass::int_add] = 4 * points;
    work.read_issued = 6 * points;  // counted before the places are known, listed, counted
    work.local_bytes = kListers * 8 * 3 * 4;
  } else if (variant == Variant::fpga) {
    work.add_loop(points, 1, static_cast<std::uint32_t>(shape["rows"] * 8));
  }
  return work;
}

KernelSpec make_list() {
  KernelSpec spec = depth_spec("support_list", "support_grid");
  spec.args = {{"grid", Access::in, ElementType::i16},
               {"list", Access::out, ElementType::i16},
               {"count", Access::out, ElementType::u32},
               integer("columns"),
               integer("rows"),
               integer("step")};
  spec.geometry = [](Variant variant, const Shape&) {
    return variant == Variant::gpu ? groups_over(kListers, 1, kListers, 1) : single_items(1);
  };
  spec.work = list_work;
  spec.gpu_local_bytes = 4 * kListers;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 4;
  spec.make_case = [](const Shape& shape, std::uint32_t seed) -> KernelCase {
    HostArray grid = random_grid(shape, seed);
    const auto values = grid.as<std::int16_t>();
    const auto points =
        std::count_if(values.begin(), values.end(), [](std::int16_t d) { return d >= 0; });
    return {shape.with("points", points),
            {std::move(grid), HostArray(ElementType::i16, 4 * points_in(shape)),
             HostArray(ElementType::u32, 1), number(shape["columns"]), number(shape["rows"]),
             number(kStep)}};
  };
  spec.golden = [](KernelCase& c) {
    golden_support_list(grid_of(c.shape), kStep, c.args[0].as<std::int16_t>(),
                        c.args[1].as<std::int16_t>(), c.args[2].as<std::uint32_t>());
  };
  spec.small_shapes = {{{"columns", 20}, {"rows", 9}}};
  spec.shapes = {{{"columns", 1}, {"rows", 1}},
                 {{"columns", 7}, {"rows", 300}},
                 {{"columns", 256}, {"rows", 144}}};
  return spec;
}

}  // namespace

const KernelSpec& support_plausible_spec() {
  static const KernelSpec spec = make_plausible();
  return spec;
}

const KernelSpec& support_redundant_spec() {
  static const KernelSpec spec = make_redundant();
  return spec;
}

const KernelSpec& support_list_spec() {
  static const KernelSpec spec = make_list();
  return spec;
}

}  // namespace partita::depth
