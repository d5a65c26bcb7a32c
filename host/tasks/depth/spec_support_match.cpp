// Spec of support_match.
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

constexpr std::int64_t kGroup = 64;

/// Grid points that are matched, and how many disparities that takes.
struct Points {
  std::uint64_t rows = 0;
  std::uint64_t columns = 0;
  std::uint64_t tried = 0;  ///< disparities weighed in one row of the grid, both directions: at
                            ///< least; the way back has more room by the disparity found
  std::uint64_t sixteens_forth = 0;  ///< steps of 16 disparities in one row, on the way there
  std::uint64_t sixteens_back = 0;   ///< and for one point on the way back, typically
};

/// Those far enough from the border; the GPU variant matches all, at the nearest place inside.
Points matched_points(Variant variant, const Shape& shape) {
  const std::int64_t last = shape["max_disparity"];
  const std::int64_t end_u = shape["width"] - 1 - kMargin;
  const bool all = variant == Variant::gpu;
  Points points;
  for (std::int64_t v = 0; v < shape["height"]; v += shape["step"]) {
    points.rows += all || (v >= kMargin && v < shape["height"] - kMargin);
  }
  for (std::int64_t u = 0; u < shape["width"]; u += shape["step"]) {
    if (!all && (u < kMargin || u > end_u)) continue;
    const std::int64_t inner = std::clamp<std::int64_t>(u, kMargin, end_u);
    ++points.columns;
    points.tried += u64(std::min(last, inner - kMargin) + 1);
    points.tried += u64(std::min(last, end_u - inner) + 1);
    points.sixteens_forth += u64(std::min(last, inner - kMargin) / 16 + 1);
    points.sixteens_back += u64(std::min(last, end_u - inner) / 16 + 1);
  }
  if (points.columns > 0)
    points.sixteens_back = (points.sixteens_back + points.columns / 2) / points.columns;
  return points;
}

runtime::LaunchGeometry geometry(Variant variant, const Shape& shape) {
  const Size grid = grid_size(size_of_shape(shape), static_cast<int>(shape["step"]));
  switch (variant) {
    case Variant::cpu:
      return single_items(grid.height);
    case Variant::gpu:
      return groups_over(grid.width * kGroup, grid.height, kGroup, 1);
    case Variant::fpga:
      break;
  }
  return single_items(1);
}

Work work_of(Variant variant, const Shape& shape) {
  const std::uint64_t width = u64(shape["width"]);
  const std::uint64_t disparities = u64(shape["max_disparity"]) + 1;
  const Points in = matched_points(variant, shape);
  const std::uint64_t matches = 2 * in.rows * in.columns;
  Work work;
  work.kind = WorkKind::gather;
  // Four distances, their sum, the key, the minimum, and the second pass's two comparisons and
  // minimum; once for each match the texture.
  work[OpClass::int_add] =
      in.rows * in.tried * (4 * kDistanceOps + 3 + 2 + 1 + 3) + matches * (kDistanceOps + 8);
  work[OpClass::int_mul] = matches * 2;
  work.read_unique = in.rows * 2 * 3 * width * kDescriptorBytes;
  const Size grid = grid_size(size_of_shape(shape), static_cast<int>(shape["step"]));
  work.written_unique = work.written_issued = area(grid) * 2;
  switch (variant) {
    case Variant::cpu:
      // Sixteen disparities at once, of four descriptors; back only from the distinct ones.
      work.read_issued =
          (in.sixteens_forth * in.rows + u64(shape["distinct"]) * in.sixteens_back) * 16 * 64 +
          (matches / 2 + u64(shape["distinct"])) * 5 * kDescriptorBytes;
      break;
    case Variant::gpu:
      // Two staged stretches for each match; five descriptors of its own for each work-item.
      work.read_issued =
          matches * kDescriptorBytes * (2 * (disparities + 4) + 5 * static_cast<unsigned>(kGroup));
      work.local_bytes = matches * 2 * (disparities + 4) * kDescriptorBytes +
                         in.rows * in.tried * 4 * kDescriptorBytes + matches * 2 * 3 * 4 * kGroup;
      break;
    case Variant::fpga:
      work.read_issued = in.rows * 4 * width * kDescriptorBytes + matches * kDescriptorBytes;
      // Rows come in over one 128-bit port a view, two descriptors a column: II = 2.
      work.add_loop(in.rows * 2 * width, 2, static_cast<std::uint32_t>(in.rows * 2 * 20));
      // One disparity per clock: every operand is on the chip, the running minimum is one
      // comparison. Two passes; an adder tree of 64 leaves and the rest make 20 stages.
      work.add_loop(in.rows * in.tried, 1, static_cast<std::uint32_t>(matches * 20));
      work.add_loop(in.rows * in.tried, 1, static_cast<std::uint32_t>(matches * 6));
      break;
  }
  return work;
}

KernelCase make_case(const Shape& shape, std::uint32_t seed) {
  const Size size = size_of_shape(shape);
  const double c = 2.0 + static_cast<double>(shape["max_disparity"]) / 8;
  const SyntheticPair pair = synthetic_pair(size, {0.02, 0.03, c}, seed);
  const auto left = describe(pair.left);
  const auto right = describe(pair.right);
  const Size grid = grid_size(size, static_cast<int>(shape["step"]));
  const SupportRules rules{static_cast<int>(shape["max_disparity"]),
                           static_cast<int>(shape["step"]), 10, 85, 2};
  return {
      shape.with("distinct", golden_distinct_points(size, left, right, rules)),
      {HostArray::of<std::uint8_t>(ElementType::u8, left),
       HostArray::of<std::uint8_t>(ElementType::u8, right), HostArray(ElementType::i16, area(grid)),
       number(size.width), number(size.height), number(shape["step"]),
       number(shape["max_disparity"]), number(10), number(85), number(2)}};
}

void golden(KernelCase& c) {
  const SupportRules rules{static_cast<int>(c.shape["max_disparity"]),
                           static_cast<int>(c.shape["step"]), 10, 85, 2};
  golden_support_match(size_of_shape(c.shape), c.args[0].as<std::uint8_t>(),
                       c.args[1].as<std::uint8_t>(), rules, c.args[2].as<std::int16_t>());
}

Shape shape_of(std::int64_t width, std::int64_t height, std::int64_t last, std::int64_t step) {
  return {{"width", width}, {"height", height}, {"max_disparity", last}, {"step", step}};
}

KernelSpec make_spec() {
  KernelSpec spec = depth_spec("support_match", "support_match");
  spec.args = {{"left", Access::in, ElementType::u8},
               {"right", Access::in, ElementType::u8},
               {"grid", Access::out, ElementType::i16},
               integer("width"),
               integer("height"),
               integer("step"),
               integer("max_disparity"),
               integer("texture"),
               integer("ratio"),
               integer("lr_threshold")};
  spec.geometry = geometry;
  spec.work = work_of;
  spec.gpu_local_bytes = 2 * (kLargestDisparity + 5) * kDescriptorBytes + kGroup * 4;
  spec.design.buffers[0] = {kFpgaWidth, 128, 4, 2};
  spec.design.buffers[1] = {256, 32, 1, 2};
  spec.design.buffer_count = 2;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 4 * kDistanceOps + 16;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_mul)] = 2;
  spec.design.operand_bits = 10;
  spec.design.memory_ports = 2;
  spec.make_case = make_case;
  spec.golden = golden;
  spec.small_shapes = {shape_of(48, 16, 15, 5)};
  spec.shapes = {shape_of(32, 16, 15, 5), shape_of(150, 40, 255, 7), shape_of(333, 75, 127, 5),
                 shape_of(1280, 720, 127, 5)};
  return spec;
}

}  // namespace

const KernelSpec& support_match_spec() {
  static const KernelSpec spec = make_spec();
  return spec;
}

}  // namespace partita::depth
