// Specs of the kernels that make the list of features: select_cells, compact, describe.
#include <algorithm>

#include "host/tasks/frontend/cases.h"
#include "host/tasks/frontend/kernels.h"
#include "host/tasks/frontend/pattern.h"
#include "host/tasks/frontend/spec_tools.h"

namespace partita::frontend {
namespace {

using runtime::Access;
using runtime::ElementType;
using runtime::HostArray;
using runtime::KernelCase;
using runtime::KernelSpec;
using runtime::LaunchGeometry;
using runtime::Shape;
using runtime::Variant;

Grid grid_of(const Shape& shape) {
  return make_grid(size_of(shape), static_cast<int>(shape["cell"]));
}

LaunchGeometry select_geometry(Variant variant, const Shape& shape) {
  const Grid grid = grid_of(shape);
  switch (variant) {
    case Variant::gpu:
      return {
          {static_cast<std::size_t>(grid.columns) * 16, static_cast<std::size_t>(grid.rows) * 4, 1},
          {16, 4, 1}};
    case Variant::cpu:
      return {{static_cast<std::size_t>(grid.rows), 1, 1}, {1, 1, 1}};
    case Variant::fpga:
      return {};
  }
  return {};
}

Work select_work(Variant variant, const Shape& shape) {
  const Size size = size_of(shape);
  const auto interior = static_cast<std::uint64_t>(size.width - 2 * kBorder) *
                        static_cast<std::uint64_t>(size.height - 2 * kBorder);
  const auto cells = static_cast<std::uint64_t>(grid_of(shape).cells());
  Work work;
  work.kind = WorkKind::reduce;
  work.read_unique = interior;
  work.written_unique = work.written_issued = cells * kPerCell * 4;
  // How many pixels have a score is not known beforehand: taken as one in eight, whose eight
  // neighbours are read and compared.
  switch (variant) {
    case Variant::gpu:
      work.read_issued = 2 * interior;
      work[OpClass::int_add] = 10 * interior + cells * kPerCell * (64 + 6 * 64);
      work.local_bytes = cells * kPerCell * 4 * (64 * 4);
      break;
    case Variant::cpu:
      work.read_issued = 9 * interior;  // without a branch
      work[OpClass::int_add] = 12 * interior;
      break;
    case Variant::fpga: {
      const auto rows = static_cast<std::uint64_t>(size.height - kBorder + 1);
      work.read_issued = work.read_unique = rows * static_cast<std::uint64_t>(size.width);
      work[OpClass::int_add] = 14 * rows * static_cast<std::uint64_t>(size.width);
      work.add_loop(2 * static_cast<std::uint64_t>(size.width + 4), 1, 2);
      work.add_loop(rows * divide_up(size.width + 2, 2), 1, 12);  // two pixels per iteration
      break;
    }
  }
  return work;
}

/// Sparse scores of few values, so that ties between neighbours occur.
GrayImage sparse_scores(Size size, std::uint32_t seed) {
  GrayImage score(size.width, size.height);
  Random random(seed);
  const int quiet = size.width / 2;  // the left half has low scores alone
  for (int y = 3; y < size.height - 3; ++y) {
    for (int x = 3; x < size.width - 3; ++x) {
      if (random.next() % 6 != 0) continue;
      const int value = x < quiet ? random.between(8, 19) : random.between(1, 12) * 20;
      score.at(x, y) = static_cast<std::uint8_t>(value);
    }
  }
  return score;
}

KernelSpec make_select() {
  KernelSpec spec;
  spec.name = spec.source = "select_cells";
  spec.gpu_local_bytes = 64 * 4;
  spec.task = "frontend";
  spec.variants = kAllVariants;
  spec.args = {{"score", Access::in, ElementType::u8},
               {"slots", Access::out, ElementType::u32},
               {"width", Access::scalar, ElementType::i32},
               {"height", Access::scalar, ElementType::i32},
               {"cell", Access::scalar, ElementType::i32},
               {"first_cell", Access::scalar, ElementType::i32},
               {"threshold_high", Access::scalar, ElementType::i32}};
  spec.geometry = select_geometry;
  spec.work = select_work;
  spec.design = design({{2050, 16, 2, 2}, {2048, 128, 1, 2}}, {{OpClass::int_add, 48}}, 32, 2);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) {
    const Size size = size_of(shape);
    const int first = static_cast<int>(seed % 3);
    const auto slots = static_cast<std::size_t>((grid_of(shape).cells() + first) * kPerCell);
    return KernelCase{shape,
                      {bytes_of(sparse_scores(size, seed)), HostArray(ElementType::u32, slots),
                       scalar(size.width), scalar(size.height),
                       scalar(static_cast<int>(shape["cell"])), scalar(first), scalar(20)}};
  };
  spec.golden = [](KernelCase& c) {
    const auto slots =
        golden::select_cells(image_of(c.args[0], size_of(c.shape)), c.args[4].as<std::int32_t>()[0],
                             c.args[6].as<std::int32_t>()[0]);
    const int first = c.args[5].as<std::int32_t>()[0];
    std::copy(slots.begin(), slots.end(), c.args[1].as<std::uint32_t>().begin() + first * kPerCell);
  };
  spec.small_shapes = {{{"width", 39}, {"height", 39}, {"cell", 2}},
                       {{"width", 60}, {"height", 49}, {"cell", 8}},
                       {{"width", 71}, {"height", 58}, {"cell", 20}}};
  spec.shapes = {{{"width", 4096}, {"height", 41}, {"cell", 2}},
                 {{"width", 65}, {"height", 300}, {"cell", 400}},
                 {{"width", 1021}, {"height", 308}, {"cell", 38}},
                 {{"width", 1280}, {"height", 720}, {"cell", 54}}};
  return spec;
}

Work compact_work(Variant variant, const Shape& shape) {
  const auto slots = static_cast<std::uint64_t>(shape["cells"]) * kPerCell;
  const auto keypoints = static_cast<std::uint64_t>(shape["keypoints"]);
  Work work;
  work.kind = variant == Variant::gpu ? WorkKind::reduce : WorkKind::serial;
  work[OpClass::int_add] = 3 * slots + 14 * keypoints;
  work[OpClass::int_mul] = 2 * keypoints;
  work.read_unique = 4 * slots;
  work.read_issued = variant == Variant::gpu ? 8 * slots : 4 * slots;  // counts first, then writes
  work.written_unique = work.written_issued = 16 * keypoints + slots + 8;
  if (variant == Variant::gpu) work.local_bytes = 256 * 4 * 8 * 3;
  if (variant == Variant::fpga) work.add_loop(slots, 1, 30);
  return work;
}

KernelSpec make_compact() {
  KernelSpec spec;
  spec.name = spec.source = "compact";
  spec.gpu_local_bytes = 2 * 256 * 4;
  spec.task = "frontend";
  spec.variants = kAllVariants;
  spec.args = {{"slots", Access::in, ElementType::u32},
               {"keypoints", Access::inout, ElementType::i32},
               {"cell_start", Access::out, ElementType::i32},
               {"count", Access::out, ElementType::i32},
               {"cells", Access::scalar, ElementType::i32},
               {"cells_level0", Access::scalar, ElementType::i32}};
  spec.geometry = [](Variant variant, const Shape&) {
    return variant == Variant::gpu ? LaunchGeometry{{256, 1, 1}, {256, 1, 1}} : LaunchGeometry{};
  };
  spec.work = compact_work;
  spec.design = design({}, {{OpClass::int_mul, 2}, {OpClass::int_add, 16}}, 32, 2);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) {
    const auto cells = static_cast<std::size_t>(shape["cells"]);
    Random random(seed);
    HostArray slots(ElementType::u32, cells * kPerCell);
    std::int64_t used_slots = 0;
    for (std::size_t i = 0; i < cells; ++i) {
      const int used = seed == 1 ? 0 : random.between(0, kPerCell);
      for (int k = 0; k < used; ++k) {
        slots.as<std::uint32_t>()[i * kPerCell + static_cast<std::size_t>(k)] = golden::corner_key(
            random.between(1, 255), random.between(0, 4095), random.between(0, 4095));
      }
      used_slots += used;
    }
    return KernelCase{shape.with("keypoints", used_slots),
                      {slots, HostArray(ElementType::i32, cells * kPerCell * 4),
                       HostArray(ElementType::i32, cells + 1), HostArray(ElementType::i32, 1),
                       scalar(static_cast<int>(cells)), scalar(static_cast<int>(cells / 2))}};
  };
  spec.golden = [](KernelCase& c) {
    const auto list =
        golden::compact(c.args[0].as<std::uint32_t>(), c.args[5].as<std::int32_t>()[0]);
    assign_records<Keypoint>(c.args[1], list.keypoints);
    assign_records<std::int32_t>(c.args[2], list.cell_start);
    c.args[3].as<std::int32_t>()[0] = static_cast<std::int32_t>(list.keypoints.size());
  };
  const auto shape = [](std::int64_t cells) { return Shape{{"cells", cells}, {"keypoints", 0}}; };
  spec.small_shapes = {shape(3), shape(1), shape(70), shape(256)};
  spec.shapes = {shape(255), shape(257), shape(500)};
  return spec;
}

Work describe_work(Variant variant, const Shape& shape) {
  const Size size = size_of(shape);
  const auto count = static_cast<std::uint64_t>(shape["keypoints"]);
  constexpr std::uint64_t kPatch = 31 * 32;
  constexpr std::uint64_t kCircle = 709;  // pixels within radius 15
  Work work;
  work.kind = WorkKind::gather;
  // Moments (mask, two sums), reduction, 32 bins with two cross products each, 256 tests of three.
  work[OpClass::int_add] = count * (4 * kPatch + 62 + 32 * 4 + 256 * 3);
  work[OpClass::int_mul] = count * (kPatch + 32 + 32 * 4);
  // The table is in constant memory: it has to cross the bus once, and is no issued global access.
  const std::uint64_t table = 32 * 256 * 4;
  switch (variant) {
    case Variant::cpu:
      work.read_issued = count * (kPatch + kPatch + 16);
      break;
    case Variant::gpu:
      work.read_issued = count * (kCircle + kPatch + 32 * 16);  // 32 work-items read the keypoint
      break;
    case Variant::fpga:
      work.read_issued = count * (kCircle + kPatch + 16);
      break;
  }
  const std::uint64_t images = 2 * (pixels(size) + pixels(level_size(size, 1)));
  work.read_unique = std::min(count * (kCircle + 31 * 31), images) + count * 16 + table;
  work.written_issued = work.written_unique = count * (32 + 16);
  if (variant == Variant::gpu) work.local_bytes = count * (kPatch + 512 + 32 * 8 * 3 + 32 * 8);
  if (variant == Variant::fpga) {
    work.add_loop(32 * 256 / 8, 1, 30);  // the table
    // Per keypoint 31 rows and 32 bytes of descriptor, and the filling of both pipelines.
    work.add_loop(count, 31 + 32 + 60, 0);
  }
  return work;
}

/// Keypoints anywhere in the interior, alternating between the levels.
std::vector<Keypoint> scattered_keypoints(Size image, std::size_t count, Random& random) {
  std::vector<Keypoint> keypoints(count);
  for (std::size_t i = 0; i < count; ++i) {
    const int level = static_cast<int>(i % 2);
    const Size size = level_size(image, level);
    const int x = random.between(kBorder, size.width - kBorder - 1);
    const int y = random.between(kBorder, size.height - kBorder - 1);
    keypoints[i] = {to_original_q8(x, level), to_original_q8(y, level), x | (y << 16),
                    random.between(1, 255) | (level << 16)};
  }
  return keypoints;
}

KernelCase describe_case(const Shape& shape, std::uint32_t seed) {
  const Size size = size_of(shape);
  const auto count = static_cast<std::size_t>(shape["keypoints"]);
  Random random(seed);
  // The first seed has a flat image: no direction, all bits zero.
  const GrayImage image =
      seed == 1 ? GrayImage(size.width, size.height, 90) : textured_image(size, seed);
  const GrayImage half = golden::pyramid_down(image);
  const auto keypoints = scattered_keypoints(size, count, random);
  return {shape,
          {bytes_of(image), bytes_of(half), bytes_of(golden::gaussian_blur(image)),
           bytes_of(golden::gaussian_blur(half)), array_of<Keypoint>(keypoints, ElementType::i32),
           HostArray(ElementType::u32, count * 8),
           HostArray::of<std::uint16_t>(ElementType::u16, test_table()), scalar(size.width),
           scalar(static_cast<int>(count))}};
}

void describe_golden(KernelCase& c) {
  const Size size = size_of(c.shape);
  std::vector<GrayImage> images;
  for (int i = 0; i < 4; ++i) {
    images.push_back(image_of(c.args[static_cast<std::size_t>(i)], level_size(size, i % 2)));
  }
  const auto count = static_cast<std::size_t>(c.shape["keypoints"]);
  const auto given = records_of<Keypoint>(c.args[4], count);
  std::vector<Keypoint> keypoints(given.begin(), given.end());
  std::vector<golden::Descriptor> descriptors;
  for (Keypoint& keypoint : keypoints) {
    const auto level = static_cast<std::size_t>(keypoint.level());
    const auto [m10, m01] = golden::moments(images[level], keypoint.x(), keypoint.y());
    const int bin = golden::direction_bin(m10, m01);
    keypoint.details |= bin << 8;
    descriptors.push_back(golden::describe(images[2 + level], keypoint.x(), keypoint.y(), bin,
                                           c.args[6].as<std::uint16_t>()));
  }
  assign_records<Keypoint>(c.args[4], keypoints);
  assign_records<golden::Descriptor>(c.args[5], descriptors);
}

KernelSpec make_describe() {
  KernelSpec spec;
  spec.name = spec.source = "describe";
  spec.gpu_local_bytes = 4 * (31 * 32 + 32 * 8 + 4 + 32 * 4);
  spec.task = "frontend";
  spec.variants = kAllVariants;
  spec.args = {{"image0", Access::in, ElementType::u8},
               {"image1", Access::in, ElementType::u8},
               {"blurred0", Access::in, ElementType::u8},
               {"blurred1", Access::in, ElementType::u8},
               {"keypoints", Access::inout, ElementType::i32},
               {"descriptors", Access::out, ElementType::u32},
               {"table", Access::in, ElementType::u16},
               {"width", Access::scalar, ElementType::i32},
               {"count", Access::scalar, ElementType::i32}};
  spec.geometry = [](Variant variant, const Shape& shape) {
    return feature_geometry(variant, shape["keypoints"], 16);
  };
  spec.work = describe_work;
  // The table in eight banks; the patch in eight copies of 31 rows.
  spec.design = design({{1024, 32, 8, 2}, {31, 256, 8, 2}},
                       {{OpClass::int_mul, 98}, {OpClass::int_add, 224}}, 16, 3);
  spec.make_case = describe_case;
  spec.golden = describe_golden;
  const auto shape = [](std::int64_t width, std::int64_t height, std::int64_t keypoints) {
    return Shape{{"width", width}, {"height", height}, {"keypoints", keypoints}};
  };
  spec.small_shapes = {shape(64, 64, 3), shape(80, 64, 5), shape(65, 77, 17)};
  spec.shapes = {shape(201, 99, 333), shape(1226, 370, 1200), shape(1280, 720, 2000)};
  return spec;
}

}  // namespace

const KernelSpec& select_cells_spec() {
  static const KernelSpec spec = make_select();
  return spec;
}

const KernelSpec& compact_spec() {
  static const KernelSpec spec = make_compact();
  return spec;
}

const KernelSpec& describe_spec() {
  static const KernelSpec spec = make_describe();
  return spec;
}

}  // namespace partita::frontend
