// Specs of grid_prior and plane_prior, and of the triangulation on the host.
#include <algorithm>
#include <bit>

#include "host/tasks/depth/geometry.h"
#include "host/tasks/depth/kernels.h"
#include "host/tasks/depth/planes.h"
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

constexpr std::int64_t kGroup = 64;

Size cells_of(const Shape& shape) {
  return cell_size(size_of_shape(shape), static_cast<int>(shape["cell"]));
}

// ---- grid_seen ----------------------------------------------------------------------------------

/// Grid points that the GPU variant looks at for all cells together.
std::uint64_t looked_at(const Shape& shape) {
  const Size grid = grid_size(size_of_shape(shape), static_cast<int>(shape["step"]));
  const Size cells = cells_of(shape);
  const std::int64_t step = shape["step"];
  const std::int64_t reach = shape["right"] != 0 ? shape["max_disparity"] : 0;
  std::uint64_t columns = 0;
  for (std::int64_t cx = 0; cx < cells.width; ++cx) {
    const std::int64_t begin = ceil_div(cx * shape["cell"], step);
    const std::int64_t end =
        std::min<std::int64_t>(ceil_div((cx + 1) * shape["cell"] + reach, step), grid.width);
    columns += u64(std::max<std::int64_t>(0, end - begin));
  }
  return columns * u64(grid.height);  // each row of the grid belongs to one row of cells
}

Work grid_seen_work(Variant variant, const Shape& shape) {
  const Size grid = grid_size(size_of_shape(shape), static_cast<int>(shape["step"]));
  const Size cells = cells_of(shape);
  const std::uint64_t words = area(cells) * kSeenWords;
  const std::uint64_t points = variant == Variant::gpu ? looked_at(shape) : area(grid);
  Work work;
  work.kind = WorkKind::reduce;
  work[OpClass::int_add] = 4 * points;
  work[OpClass::int_mul] = points;
  work.read_unique = 2 * area(grid);
  work.read_issued = 2 * points;
  work.written_unique = work.written_issued = 4 * words;
  if (variant == Variant::gpu) {
    work[OpClass::atomic] = area(grid);  // about a third of the points are there, three bits each
    work.local_bytes = 4 * words * 2 + 4 * area(grid);
  } else {
    work[OpClass::int_special] = area(grid);
  }
  if (variant == Variant::fpga) {
    // Clearing, marking and writing a row of cells. A point's three bits lie in two words at most,
    // of a memory with as many banks as a cell has words; a point may meet the words of the one
    // before, whose update takes 2 clocks.
    const auto rows = static_cast<std::uint32_t>(cells.height);
    work.add_loop(words, 1, rows * 4);
    work.add_loop(area(grid), 2, static_cast<std::uint32_t>(grid.height) * 14);
    work.add_loop(words, 1, rows * 6);
  }
  return work;
}

KernelCase grid_seen_case(const Shape& shape, std::uint32_t seed) {
  const int step = static_cast<int>(shape["step"]);
  const Size grid = grid_size(size_of_shape(shape), step);
  const Size cells = cells_of(shape);
  const int last = static_cast<int>(shape["max_disparity"]);
  const auto values = synthetic_grid(size_of_shape(shape), step, last, 40, seed);
  return {shape,
          {HostArray::of<std::int16_t>(ElementType::i16, values),
           HostArray(ElementType::u32, area(cells) * kSeenWords), number(cells.width),
           number(cells.height), number(shape["cell"]), number(grid.width), number(grid.height),
           number(step), number(last), number(shape["right"])}};
}

Shape seen_shape(std::int64_t width, std::int64_t height, std::int64_t last, bool right,
                 std::int64_t cell = 20) {
  return {{"width", width}, {"height", height},      {"cell", cell},
          {"step", 5},      {"max_disparity", last}, {"right", right}};
}

KernelSpec make_grid_seen() {
  KernelSpec spec = depth_spec("grid_seen", "prior");
  spec.args = {{"grid", Access::in, ElementType::i16},
               {"seen", Access::out, ElementType::u32},
               integer("columns"),
               integer("rows"),
               integer("cell"),
               integer("grid_columns"),
               integer("grid_rows"),
               integer("step"),
               integer("max_disparity"),
               integer("right")};
  spec.geometry = [](Variant variant, const Shape& shape) {
    const Size cells = cells_of(shape);
    if (variant == Variant::gpu) return groups_over(cells.width * kGroup, cells.height, kGroup, 1);
    return single_items(variant == Variant::cpu ? cells.height : 1);
  };
  spec.work = grid_seen_work;
  spec.gpu_local_bytes = 4 * kSeenWords;
  spec.design.buffers[0] = {kFpgaWidth / kSmallestCell, 32, kSeenWords, 2};
  spec.design.buffer_count = 1;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 16;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_mul)] = 2;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_special)] = 1;
  spec.make_case = grid_seen_case;
  spec.golden = [](KernelCase& c) {
    const Size size = size_of_shape(c.shape);
    const int step = static_cast<int>(c.shape["step"]);
    golden_grid_seen(size, static_cast<int>(c.shape["cell"]), grid_size(size, step),
                     c.args[0].as<std::int16_t>(), step, static_cast<int>(c.shape["max_disparity"]),
                     c.shape["right"] != 0, c.args[1].as<std::uint32_t>());
  };
  spec.small_shapes = {seen_shape(64, 44, 15, false), seen_shape(64, 44, 15, true)};
  spec.shapes = {seen_shape(32, 16, 31, true), seen_shape(333, 75, 255, false, 8),
                 seen_shape(333, 75, 255, true, 64), seen_shape(1280, 720, 127, true)};
  return spec;
}

// ---- grid_prior ---------------------------------------------------------------------------------

/// Cells looked at for all cells together: each and its neighbours.
std::uint64_t neighbours(Size cells) {
  return u64(3 * cells.width - 2) * u64(3 * cells.height - 2);
}

Work grid_prior_work(Variant variant, const Shape& shape) {
  const Size cells = cells_of(shape);
  const std::uint64_t count = area(cells);
  const std::uint64_t disparities = u64(shape["max_disparity"]) + 1;
  const std::uint64_t words = neighbours(cells) * kSeenWords;
  Work work;
  work.kind = WorkKind::reduce;
  work[OpClass::int_add] = words + 3 * count * disparities;
  work.read_unique = count * kSeenWords * 4;
  work.read_issued = 4 * words;
  work.written_unique = work.written_issued = u64(shape["listed"]) + 2 * count;
  if (variant == Variant::gpu) {
    work[OpClass::int_special] = u64(shape["listed"]) * 2 + count * kSeenWords;
    work.local_bytes = count * (kSeenWords * 8 + 4 * disparities);
  } else if (variant == Variant::fpga) {
    // One cell, then one disparity per clock; a row of cells or a list fills the pipeline anew (10
    // stages). A cell's words come over one port: eight clocks.
    work.add_loop(neighbours(cells), kSeenWords, static_cast<std::uint32_t>(count * 3 * 10));
    work.add_loop(count * disparities, 1, static_cast<std::uint32_t>(count * 10));
  }
  return work;
}

KernelCase grid_prior_case(const Shape& shape, std::uint32_t seed) {
  const Size size = size_of_shape(shape);
  const int last = static_cast<int>(shape["max_disparity"]);
  const int step = 5;
  const Size cells = cells_of(shape);
  const auto values = synthetic_grid(size, step, last, 10, seed);
  std::vector<std::uint32_t> seen(area(cells) * kSeenWords);
  golden_grid_seen(size, static_cast<int>(shape["cell"]), grid_size(size, step), values, step, last,
                   false, seen);
  std::vector<std::uint16_t> counts(area(cells));
  std::vector<std::uint8_t> lists(area(cells) * static_cast<std::size_t>(last + 1));
  golden_grid_prior(cells, seen, last, counts, lists);
  std::int64_t listed = 0;
  for (const std::uint16_t n : counts) listed += n;
  return {shape.with("listed", listed),
          {HostArray::of<std::uint32_t>(ElementType::u32, seen),
           HostArray(ElementType::u16, counts.size()), HostArray(ElementType::u8, lists.size()),
           number(cells.width), number(cells.height), number(last)}};
}

Shape prior_shape(std::int64_t width, std::int64_t height, std::int64_t last,
                  std::int64_t cell = 20) {
  return {{"width", width}, {"height", height}, {"cell", cell}, {"max_disparity", last}};
}

KernelSpec make_grid_prior() {
  KernelSpec spec = depth_spec("grid_prior", "prior");
  spec.args = {{"seen", Access::in, ElementType::u32},
               {"counts", Access::out, ElementType::u16},
               {"lists", Access::out, ElementType::u8},
               integer("columns"),
               integer("rows"),
               integer("max_disparity")};
  spec.geometry = [](Variant variant, const Shape& shape) {
    const Size cells = cells_of(shape);
    if (variant == Variant::gpu) return groups_over(cells.width * kGroup, cells.height, kGroup, 1);
    return single_items(variant == Variant::cpu ? cells.height : 1);
  };
  spec.work = grid_prior_work;
  spec.gpu_local_bytes = 4 * kSeenWords;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 24;
  spec.design.operand_bits = 32;
  spec.make_case = grid_prior_case;
  spec.golden = [](KernelCase& c) {
    golden_grid_prior(cells_of(c.shape), c.args[0].as<std::uint32_t>(),
                      static_cast<int>(c.shape["max_disparity"]), c.args[1].as<std::uint16_t>(),
                      c.args[2].as<std::uint8_t>());
  };
  spec.small_shapes = {prior_shape(64, 44, 15)};
  spec.shapes = {prior_shape(32, 16, 31), prior_shape(333, 75, 255, 8), prior_shape(333, 75, 255),
                 prior_shape(1280, 720, 127)};
  return spec;
}

// ---- plane_prior --------------------------------------------------------------------------------

Work plane_prior_work(Variant variant, const Shape& shape) {
  const std::uint64_t pixels = u64(shape["width"] * shape["height"]);
  const std::uint64_t triangles = u64(shape["triangles"]);
  const std::uint64_t spans = u64(shape["spans"]);
  const std::uint64_t covered = u64(shape["covered"]);
  Work work;
  work.kind = WorkKind::gather;
  work[OpClass::int_add] = spans * 12 + covered * 4;
  work[OpClass::int_mul] = spans * 3 + covered;
  work[OpClass::int_special] = spans * 2;
  work.read_unique = work.read_issued = triangles * 32;
  work.written_unique = 2 * pixels;
  work.written_issued = 2 * (pixels + covered);
  if (variant == Variant::fpga) {
    // Clearing, then one pixel per clock; a triangle's row first needs two divisions (40 stages).
    work.add_loop(pixels, 1, 10);
    work.add_loop(covered, 1, static_cast<std::uint32_t>(spans * 40));
  } else {
    // Every band of rows looks at all triangles' corners and at the planes of those it meets.
    const std::uint64_t bands = u64(ceil_div(shape["height"], kBand));
    work[OpClass::int_add] += bands * triangles * 2;
    work.read_issued = bands * triangles * 16 + u64(shape["overlaps"]) * 16;
  }
  return work;
}

KernelCase plane_prior_case(const Shape& shape, std::uint32_t seed) {
  const Size size = size_of_shape(shape);
  constexpr int kStep = 5;
  const auto values = synthetic_grid(size, kStep, 31, static_cast<int>(shape["percent"]), seed);
  Mesh mesh = make_mesh(points_of(grid_size(size, kStep), kStep, values), seed % 2 == 0);
  HostArray map(ElementType::i16, area(size));
  // The pixels covered, exactly: all planes made usable for the count.
  std::vector<std::int32_t> usable = mesh.planes;
  for (std::size_t k = 3; k < usable.size(); k += kPlaneEntries) usable[k] = 1;
  golden_plane_prior(size, mesh.corners, usable, mesh.triangles, map.as<std::int16_t>());
  const auto filled = map.as<std::int16_t>();
  const auto covered =
      std::count_if(filled.begin(), filled.end(), [](std::int16_t m) { return m != kNoPlane; });
  if (mesh.triangles == 0) {  // a buffer has to have a size
    mesh.corners.assign(kCornerEntries, 0);
    mesh.planes.assign(kPlaneEntries, 0);
  }
  return {shape.with("triangles", mesh.triangles)
              .with("spans", mesh.spans)
              .with("overlaps", mesh.overlaps)
              .with("covered", covered),
          {HostArray::of<std::int16_t>(ElementType::i16, mesh.corners),
           HostArray::of<std::int32_t>(ElementType::i32, mesh.planes),
           HostArray(ElementType::i16, area(size)), number(size.width), number(size.height),
           number(mesh.triangles)}};
}

KernelSpec make_plane_prior() {
  KernelSpec spec = depth_spec("plane_prior", "prior");
  spec.args = {{"corners", Access::in, ElementType::i16},
               {"planes", Access::in, ElementType::i32},
               {"map", Access::out, ElementType::i16},
               integer("width"),
               integer("height"),
               integer("triangles")};
  spec.geometry = [](Variant variant, const Shape& shape) {
    const std::int64_t bands = ceil_div(shape["height"], kBand);
    if (variant == Variant::gpu) return groups_over(bands * kGroup, 1, kGroup, 1);
    return single_items(variant == Variant::cpu ? bands : 1);
  };
  spec.work = plane_prior_work;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 24;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_mul)] = 5;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_special)] = 2;
  spec.design.operand_bits = 32;
  spec.design.memory_ports = 2;
  spec.make_case = plane_prior_case;
  spec.golden = [](KernelCase& c) {
    golden_plane_prior(size_of_shape(c.shape), c.args[0].as<std::int16_t>(),
                       c.args[1].as<std::int32_t>(), static_cast<int>(c.shape["triangles"]),
                       c.args[2].as<std::int16_t>());
  };
  spec.small_shapes = {{{"width", 64}, {"height", 44}, {"percent", 20}}};
  spec.shapes = {{{"width", 32}, {"height", 16}, {"percent", 0}},
                 {{"width", 333}, {"height", 75}, {"percent", 5}},
                 {{"width", 333}, {"height", 75}, {"percent", 70}},
                 {{"width", 1280}, {"height", 720}, {"percent", 8}}};
  return spec;
}

runtime::HostSpec make_triangulation() {
  runtime::HostSpec spec{"triangulation", "depth", {}};
  spec.work = [](const Shape& shape) {
    // Fortune's sweep: a search in the beach line for each of n points and about 2 n circle events,
    // each with exact predicates of some 100 operations; then sorting, and a plane per triangle.
    const std::uint64_t n = u64(shape["points"]);
    const std::uint64_t steps = n * static_cast<std::uint64_t>(std::bit_width(n));
    Work work;
    work.kind = WorkKind::serial;
    work[OpClass::int_add] = 300 * steps;
    work[OpClass::int_mul] = 20 * steps;
    work[OpClass::int_special] = 4 * n;  // two divisions a triangle
    work[OpClass::double_add] = 40 * steps;
    work[OpClass::double_mul] = 40 * steps;
    work[OpClass::double_special] = 8 * n;
    work.read_unique = work.read_issued = 8 * n;
    work.written_unique = work.written_issued = 32 * u64(shape["triangles"]);
    return work;
  };
  return spec;
}

}  // namespace

const KernelSpec& grid_seen_spec() {
  static const KernelSpec spec = make_grid_seen();
  return spec;
}

const KernelSpec& grid_prior_spec() {
  static const KernelSpec spec = make_grid_prior();
  return spec;
}

const KernelSpec& plane_prior_spec() {
  static const KernelSpec spec = make_plane_prior();
  return spec;
}

const runtime::HostSpec& triangulation_spec() {
  static const runtime::HostSpec spec = make_triangulation();
  return spec;
}

}  // namespace partita::depth
