// Specs of dense_match and consistency, and the task's lists of specs.
#include <algorithm>
#include <random>

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

constexpr std::int64_t kGroupX = 64;
constexpr std::int64_t kGroupY = 4;

std::uint64_t groups(const Shape& shape) {
  return u64(ceil_div(shape["width"], kGroupX) * ceil_div(shape["height"], kGroupY));
}

// ---- dense_match --------------------------------------------------------------------------------

Work dense_work(Variant variant, const Shape& shape) {
  const std::uint64_t width = u64(shape["width"]);
  const std::uint64_t height = u64(shape["height"]);
  const std::uint64_t pixels = width * height;
  const std::uint64_t entries = u64(shape["entries"]);  // of the lists, over all pixels
  const std::uint64_t planes = u64(shape["planes"]);    // pixels with a plane
  const std::uint64_t around = 2 * u64(shape["radius"]);
  const std::uint64_t candidates = entries + around * planes;
  const std::uint64_t refined = shape["right"] != 0 ? 0 : pixels;
  const std::uint64_t table = 2 * u64(prior_entries(static_cast<int>(shape["radius"])));
  const auto side = u64(shape["cell"]);
  const Size cells = cell_size(size_of_shape(shape), static_cast<int>(shape["cell"]));
  Work work;
  work.kind = WorkKind::gather;
  // Distance, energy, key, minimum; for those of a plane the distance from it; the texture; three
  // distances and the parabola.
  work[OpClass::int_add] = candidates * (kDistanceOps + 4) + planes * around * 3 +
                           pixels * (kDistanceOps + 3) + refined * (2 * kDistanceOps + 8);
  work[OpClass::int_special] = refined / 2;
  work.read_unique =
      pixels * (2 * kDescriptorBytes + 2) + area(cells) * 2 + entries / (side * side);
  work.written_unique = work.written_issued = 2 * pixels;
  switch (variant) {
    case Variant::cpu: {
      // Vectors of four descriptors: of the pixels for the list and for the texture, of a listed
      // disparity's; and for each pixel with a plane its own and those around the plane.
      const std::uint64_t groups = u64(shape["radius"] + 1) / 2;
      work.read_issued = pixels * (2 * kDescriptorBytes + 2) + entries * kDescriptorBytes +
                         entries / 16 + planes * (1 + 4 * groups) * kDescriptorBytes +
                         refined * 5 * kDescriptorBytes + area(cells) * 3 +
                         u64(cells.height) * groups * 16 * 4 * 2;
      break;
    }
    case Variant::gpu:
      work.read_issued =
          groups(shape) *
              (u64(kGroupY * (kGroupX + shape["max_disparity"])) * kDescriptorBytes + table) +
          pixels * (kDescriptorBytes + 4) + entries;
      work.local_bytes =
          groups(shape) * u64(kGroupY * (kGroupX + shape["max_disparity"])) * kDescriptorBytes +
          (candidates + 3 * refined) * kDescriptorBytes;
      break;
    case Variant::fpga:
      work.read_issued = pixels * (2 * kDescriptorBytes + 2) + height * u64(cells.width) * 2 +
                         entries / side + table;
      // A row of both views comes in over two ports, then a cell's list; then one candidate of one
      // pixel per clock, all operands on the chip; a pixel's minimum is due again after the whole
      // cell, longer than the 16 stages. Last the decisions: three distances of a pixel, two ports
      // of the row's memory, and a division of 20 stages.
      work.add_loop(pixels, 2, static_cast<std::uint32_t>(height * 20));
      work.add_loop(entries / side, 1, static_cast<std::uint32_t>(height * u64(cells.width) * 8));
      work.add_loop(entries + around * pixels, 1,
                    static_cast<std::uint32_t>(height * u64(cells.width) * 16));
      work.add_loop(pixels, 2, static_cast<std::uint32_t>(height * u64(cells.width) * 40));
      break;
  }
  return work;
}

struct DenseInputs {
  std::vector<std::int16_t> map;
  std::vector<std::uint16_t> counts;
  std::vector<std::uint8_t> lists;
  std::int64_t entries = 0;
  std::int64_t planes = 0;
};

/// Planes and lists at random: near the truth, off it, out of range, and none.
DenseInputs random_priors(Size size, int cell_side, int last, std::uint32_t seed) {
  std::mt19937 random(seed);
  const Size cells = cell_size(size, cell_side);
  DenseInputs in;
  in.counts.resize(area(cells));
  in.lists.resize(area(cells) * static_cast<std::size_t>(last + 1));
  for (int cy = 0; cy < cells.height; ++cy) {
    for (int cx = 0; cx < cells.width; ++cx) {
      const auto cell = static_cast<std::size_t>(cy * cells.width + cx);
      std::uint16_t n = 0;
      for (int d = static_cast<int>(random() % 4); d <= last;
           d += 1 + static_cast<int>(random() % 9)) {
        in.lists[cell * static_cast<std::size_t>(last + 1) + n++] = static_cast<std::uint8_t>(d);
      }
      in.counts[cell] = n;
      in.entries += std::int64_t{n} * std::min(cell_side, size.width - cx * cell_side) *
                    std::min(cell_side, size.height - cy * cell_side);
    }
  }
  for (std::size_t i = 0; i < area(size); ++i) {
    const int spread = 16 * (last + 8);
    const int mu = static_cast<int>(random() % static_cast<unsigned>(spread)) - 64;
    const bool none = random() % 5 == 0;
    in.map.push_back(none ? kNoPlane : static_cast<std::int16_t>(mu));
    in.planes += !none;
  }
  return in;
}

KernelCase dense_case(const Shape& shape, std::uint32_t seed) {
  const Size size = size_of_shape(shape);
  const int last = static_cast<int>(shape["max_disparity"]);
  const SyntheticPair pair = synthetic_pair(size, {0.02, 0.03, 2.0 + last / 8.0}, seed);
  const bool right = shape["right"] != 0;
  const auto own = describe(right ? pair.right : pair.left);
  const auto other = describe(right ? pair.left : pair.right);
  const DenseInputs in = random_priors(size, static_cast<int>(shape["cell"]), last, seed);
  const int radius = static_cast<int>(shape["radius"]);
  const auto prior = prior_energies(0.02, 3, 1, radius);
  return {shape.with("entries", in.entries).with("planes", in.planes),
          {HostArray::of<std::uint8_t>(ElementType::u8, own),
           HostArray::of<std::uint8_t>(ElementType::u8, other),
           HostArray::of<std::int16_t>(ElementType::i16, in.map),
           HostArray::of<std::uint16_t>(ElementType::u16, in.counts),
           HostArray::of<std::uint8_t>(ElementType::u8, in.lists),
           HostArray::of<std::uint16_t>(ElementType::u16, prior),
           HostArray(ElementType::u16, area(size)), number(size.width), number(size.height),
           number(shape["cell"]), number(last), number(radius), number(right), number(60)}};
}

void dense_golden(KernelCase& c) {
  const DenseRules rules{static_cast<int>(c.shape["cell"]),
                         static_cast<int>(c.shape["max_disparity"]),
                         static_cast<int>(c.shape["radius"]), 60, c.shape["right"] != 0};
  golden_dense_match(size_of_shape(c.shape), c.args[0].as<std::uint8_t>(),
                     c.args[1].as<std::uint8_t>(), c.args[2].as<std::int16_t>(),
                     c.args[3].as<std::uint16_t>(), c.args[4].as<std::uint8_t>(),
                     c.args[5].as<std::uint16_t>(), rules, c.args[6].as<std::uint16_t>());
}

Shape dense_shape(std::int64_t width, std::int64_t height, std::int64_t last, bool right,
                  std::int64_t cell = 20, std::int64_t radius = 2) {
  return {{"width", width}, {"height", height}, {"max_disparity", last},
          {"right", right}, {"cell", cell},     {"radius", radius}};
}

KernelSpec make_dense() {
  KernelSpec spec = depth_spec("dense_match", "dense_match");
  spec.args = {{"own", Access::in, ElementType::u8},
               {"other", Access::in, ElementType::u8},
               {"map", Access::in, ElementType::i16},
               {"counts", Access::in, ElementType::u16},
               {"lists", Access::in, ElementType::u8},
               {"prior", Access::in, ElementType::u16},
               {"disparities", Access::out, ElementType::u16},
               integer("width"),
               integer("height"),
               integer("cell"),
               integer("max_disparity"),
               integer("radius"),
               integer("right"),
               integer("texture")};
  spec.geometry = [](Variant variant, const Shape& shape) {
    if (variant == Variant::gpu) {
      return groups_over(shape["width"], shape["height"], kGroupX, kGroupY);
    }
    return single_items(variant == Variant::cpu ? ceil_div(shape["height"], shape["cell"]) : 1);
  };
  spec.work = dense_work;
  spec.gpu_local_bytes = kGroupY * (kGroupX + kLargestDisparity) * kDescriptorBytes +
                         2 * prior_entries(kLargestRadius);
  spec.design.buffers[0] = {kFpgaWidth, 128, 2, 2};
  spec.design.buffers[1] = {kFpgaWidth, 16, 1, 2};
  spec.design.buffers[2] = {256, 8, 1, 2};
  spec.design.buffers[3] = {kLargestCell, 32, 1, 2};
  spec.design.buffers[4] = {u64(prior_entries(kLargestRadius)), 16, 1, 2};
  spec.design.buffer_count = 5;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 5 * kDistanceOps + 30;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_special)] = 1;
  spec.design.operand_bits = 12;
  spec.design.memory_ports = 3;
  spec.make_case = dense_case;
  spec.golden = dense_golden;
  spec.small_shapes = {dense_shape(48, 12, 7, false), dense_shape(48, 12, 7, true)};
  spec.shapes = {dense_shape(32, 16, 31, true), dense_shape(67, 45, 66, false, 13, 3),
                 dense_shape(333, 75, 255, false, 8, 16), dense_shape(333, 75, 255, true, 64, 5),
                 dense_shape(1280, 720, 127, false)};
  return spec;
}

// ---- consistency --------------------------------------------------------------------------------

Work consistency_work(Variant variant, const Shape& shape) {
  const std::uint64_t pixels = u64(shape["width"] * shape["height"]);
  Work work;
  work.kind = WorkKind::gather;
  work[OpClass::int_add] = 10 * pixels;
  work.read_unique = work.read_issued = 4 * pixels;
  work.written_unique = work.written_issued = 2 * pixels;
  if (variant == Variant::fpga) {
    const auto rows = static_cast<std::uint32_t>(shape["height"]);
    work.add_loop(pixels, 1, rows * 6);   // the right view's row comes in
    work.add_loop(pixels, 1, rows * 12);  // one pixel per clock
  }
  return work;
}

KernelCase consistency_case(const Shape& shape, std::uint32_t seed) {
  std::mt19937 random(seed);
  HostArray left(ElementType::u16, pixels_of(shape));
  HostArray right(ElementType::u16, pixels_of(shape));
  for (HostArray* view : {&left, &right}) {
    for (std::uint16_t& d : view->as<std::uint16_t>()) {
      d = static_cast<std::uint16_t>(random() % 8 == 0 ? random() % 2 : random() % 3000);
    }
  }
  return {shape,
          {std::move(left), std::move(right), HostArray(ElementType::u16, pixels_of(shape)),
           number(shape["width"]), number(shape["height"]), number(2)}};
}

KernelSpec make_consistency() {
  KernelSpec spec = depth_spec("consistency", "dense_match");
  spec.args = {{"left", Access::in, ElementType::u16},
               {"right", Access::in, ElementType::u16},
               {"out", Access::out, ElementType::u16},
               integer("width"),
               integer("height"),
               integer("lr_threshold")};
  spec.geometry = [](Variant variant, const Shape& shape) {
    if (variant == Variant::gpu) {
      return groups_over(shape["width"], shape["height"], kGroupX, kGroupY);
    }
    return single_items(variant == Variant::cpu ? ceil_div(shape["height"], kBand) : 1);
  };
  spec.work = consistency_work;
  spec.design.buffers[0] = {kFpgaWidth, 16, 1, 2};
  spec.design.buffer_count = 1;
  spec.design.operators[static_cast<std::size_t>(OpClass::int_add)] = 12;
  spec.design.memory_ports = 2;
  spec.make_case = consistency_case;
  spec.golden = [](KernelCase& c) {
    golden_consistency(size_of_shape(c.shape), c.args[0].as<std::uint16_t>(),
                       c.args[1].as<std::uint16_t>(), 2, c.args[2].as<std::uint16_t>());
  };
  spec.small_shapes = {{{"width", 40}, {"height", 9}}};
  spec.shapes = {{{"width", 1}, {"height", 1}},
                 {{"width", 333}, {"height", 75}},
                 {{"width", 1280}, {"height", 720}}};
  return spec;
}

}  // namespace

const KernelSpec& dense_match_spec() {
  static const KernelSpec spec = make_dense();
  return spec;
}

const KernelSpec& consistency_spec() {
  static const KernelSpec spec = make_consistency();
  return spec;
}

std::vector<const KernelSpec*> kernel_specs() {
  return {&sobel_spec(),
          &descriptor_spec(),
          &support_match_spec(),
          &support_plausible_spec(),
          &support_redundant_spec(),
          &support_list_spec(),
          &grid_seen_spec(),
          &grid_prior_spec(),
          &plane_prior_spec(),
          &dense_match_spec(),
          &consistency_spec(),
          &segments_spec(),
          &join_segments_spec(),
          &remove_speckles_spec(),
          &fill_gaps_spec(),
          &adaptive_mean_spec(),
          &median_spec()};
}

std::vector<const runtime::HostSpec*> host_specs() {
  return {&triangulation_spec()};
}

}  // namespace partita::depth
