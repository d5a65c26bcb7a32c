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

// ---- grid_prior ---------------------------------------------------------------------------------

/// Grid points that are looked at for all cells together.
std::uint64_t looked_at(const Shape& shape) {
  const Size grid = grid_size(size_of_shape(shape), static_cast<int>(shape["step"]));
  const Size cells = cell_size(size_of_shape(shape));
  const std::int64_t step = shape["step"];
  const std::int64_t reach = shape["right"] != 0 ? shape["max_disparity"] : 0;
  std::uint64_t columns = 0;
  for (std::int64_t cx = 0; cx < cells.width; ++cx) {
    const std::int64_t begin = ceil_div(cx * kCell, step);
    const std::int64_t end =
        std::min<std::int64_t>(ceil_div((cx + 1) * kCell + reach, step), grid.width);
    columns += u64(std::max<std::int64_t>(0, end - begin));
  }
  return columns * u64(grid.height);  // each row of the grid belongs to one row of cells
}

Work grid_prior_work(Variant variant, const Shape& shape) {
  const Size grid = grid_size(size_of_shape(shape), static_cast<int>(shape["step"]));
  const std::uint64_t cells = area(cell_size(size_of_shape(shape)));
  const std::uint64_t disparities = u64(shape["max_disparity"]) + 1;
  const std::uint64_t points = looked_at(shape);
  Work work;
  work.kind = WorkKind::reduce;
  work[OpClass::int_add] = 4 * points + cells * disparities;
  work[OpClass::int_mul] = points;
  work.read_unique = 2 * area(grid);
  work.read_issued = 2 * points;
  work.written_unique = work.written_issued = u64(shape["listed"]) + 2 * cells;
  if (variant == Variant::gpu) {
    work[OpClass::atomic] = 3 * u64(shape["listed"]) / 2;
    work[OpClass::int_special] = u64(shape["listed"]) * 3 + cells * 9;
    work.local_bytes = cells * (9 * 8 + 4 * disparities);
  } else if (variant == Variant::fpga) {
    // One grid point, then one disparity per clock; a row of points or a list fills the pipeline
    // anew (10 stages).
    work.add_loop(points, 1, static_cast<std::uint32_t>(cells * 4 * 10));
    work.add_loop(cells * disparities, 1, static_cast<std::uint32_t>(cells * 10));
  }
  return work;
}

KernelCase grid_prior_case(const Shape& shape, std::uint32_t seed) {
  const Size size = size_of_shape(shape);
  const int last = static_cast<int>(shape["max_disparity"]);
  const int step = static_cast<int>(shape["step"]);
  const bool right = shape["right"] != 0;
  const Size grid = grid_size(size, step);
  const Size cells = cell_size(size);
  const auto values = synthetic_grid(size, step, last, 40, seed);
  std::vector<std::uint16_t> counts(area(cells));
  std::vector<std::uint8_t> lists(area(cells) * static_cast<std::size_t>(last + 1));
  golden_grid_prior(size, grid, values, step, last, right, counts, lists);
  std::int64_t listed = 0;
  for (const std::uint16_t n : counts) listed += n;
  return {shape.with("listed", listed),
          {HostArray::of<std::int16_t>(ElementType::i16, values),
           HostArray(ElementType::u16, counts.size()), HostArray(ElementType::u8, lists.size()),
           number(cells.width), number(cells.height), number(grid.width), number(grid.height),
           number(step), number(last), number(right)}};
}

Shape grid_shape(std::int64_t width, std::int64_t height, std::int64_t last, bool right) {
  return {
      {"width", width}, {"height", height}, {"step", 5}, {"max_disparity", last}, {"right", right}};
}

KernelSpec make_grid_prior() {
  KernelSpec spec = depth_spec("grid_prior", "prior");
  spec.args = {{"grid", Access::in, ElementType::i16},
               {"counts", Access::out, ElementType::u16},
               {"lists", Access::out, ElementType::u8},
               integer("columns"),
               integer("rows"),
               integer("grid_columns"),
               integer("grid_rows"),
               integer("step"),
               integer("max_disparity"),
               integer("right")};
  spec.geometry = [](Variant variant, const Shape& shape) {
    const Size cells = cell_size(size_of_shape(shape));
    if (variant == Variant::gpu) return groups_over(cells.width * kGroup, cells.height, kGroup, 1);
    return single_items(variant == Variant::cpu ? cells.height : 1);
  };
  spec.work = grid_prior_work;
  spec.gpu_local_bytes = 9 * 4;
  spec.design.buffers[0] = {258, 1, 1, 2};
  spec.design.buffer_count = 1;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 10;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_mul)] = 2;
  spec.make_case = grid_prior_case;
  spec.golden = [](KernelCase& c) {
    const Size size = size_of_shape(c.shape);
    const int step = static_cast<int>(c.shape["step"]);
    golden_grid_prior(size, grid_size(size, step), c.args[0].as<std::int16_t>(), step,
                      static_cast<int>(c.shape["max_disparity"]), c.shape["right"] != 0,
                      c.args[1].as<std::uint16_t>(), c.args[2].as<std::uint8_t>());
  };
  spec.small_shapes = {grid_shape(64, 44, 15, false), grid_shape(64, 44, 15, true)};
  spec.shapes = {grid_shape(32, 16, 31, true), grid_shape(333, 75, 255, false),
                 grid_shape(333, 75, 255, true), grid_shape(1280, 720, 127, true)};
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
