// Specs of the kernels behind match_window: invert_matches and refine_sad.
#include <algorithm>

#include "host/tasks/frontend/cases.h"
#include "host/tasks/frontend/kernels.h"
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

int value_of(const HostArray& array) {
  return array.as<std::int32_t>()[0];
}

Work invert_work(Variant variant, const Shape& shape) {
  const auto queries = static_cast<std::uint64_t>(shape["queries"]);
  const auto trains = static_cast<std::uint64_t>(shape["trains"]);
  Work work;
  work.kind = variant == Variant::gpu ? WorkKind::reduce : WorkKind::serial;
  work.read_unique = 8 * queries;
  work.written_unique = work.written_issued = 8 * trains;
  if (variant == Variant::gpu) {
    const std::uint64_t rounded = round_up(shape["trains"], 128);
    work[OpClass::int_add] = 2 * queries * rounded;
    work.read_issued = 8 * queries * (rounded / 128);
    work.local_bytes = 8 * queries * (rounded / 128) + 8 * queries * rounded;
    return work;
  }
  work[OpClass::int_add] = 2 * queries;
  work.read_issued = 8 * queries;
  if (variant == Variant::fpga) {
    work.add_loop(trains, 1, 2);
    work.add_loop(queries, 2, 20);  // read, compare and write of one entry follow each other
    work.add_loop(trains, 1, 20);
  }
  return work;
}

KernelSpec make_invert() {
  KernelSpec spec;
  spec.name = spec.source = "invert_matches";
  spec.gpu_local_bytes = 128 * 8;
  spec.task = "frontend";
  spec.variants = kAllVariants;
  spec.args = {{"matches", Access::in, ElementType::i32},
               {"inverse", Access::out, ElementType::i32},
               {"queries", Access::scalar, ElementType::i32},
               {"trains", Access::scalar, ElementType::i32}};
  spec.geometry = [](Variant variant, const Shape& shape) {
    return variant == Variant::gpu
               ? LaunchGeometry{{round_up(shape["trains"], 128), 1, 1}, {128, 1, 1}}
               : LaunchGeometry{};
  };
  spec.work = invert_work;
  spec.design = design({{2048, 64, 1, 2}}, {{OpClass::int_add, 4}}, 32, 2);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) {
    const auto queries = static_cast<std::size_t>(shape["queries"]);
    const int trains = static_cast<int>(shape["trains"]);
    Random random(seed);
    std::vector<Match> matches(queries);
    for (Match& match : matches) {
      if (random.next() % 4 != 0) match = {random.between(0, trains - 1), random.between(0, 12)};
    }
    return KernelCase{shape,
                      {array_of<Match>(matches, ElementType::i32),
                       HostArray(ElementType::i32, static_cast<std::size_t>(trains) * 2),
                       scalar(static_cast<int>(queries)), scalar(trains)}};
  };
  spec.golden = [](KernelCase& c) {
    const auto matches = records_of<Match>(c.args[0], static_cast<std::size_t>(c.shape["queries"]));
    assign_records<Match>(c.args[1], golden::invert_matches(matches, value_of(c.args[3])));
  };
  const auto shape = [](std::int64_t queries, std::int64_t trains) {
    return Shape{{"queries", queries}, {"trains", trains}};
  };
  spec.small_shapes = {shape(1, 1), shape(50, 30), shape(129, 200)};
  spec.shapes = {shape(7, 2048), shape(2048, 3), shape(1300, 1500), shape(2048, 2048)};
  return spec;
}

Work refine_work(Variant variant, const Shape& shape) {
  const auto queries = static_cast<std::uint64_t>(shape["queries"]);
  const auto matches = static_cast<std::uint64_t>(shape["matches"]);
  const auto across = static_cast<std::uint64_t>(2 * shape["range_x"] + 1);
  const auto down = static_cast<std::uint64_t>(2 * shape["range_y"] + 1);
  const std::uint64_t positions = across * down;
  const std::uint64_t window = (across + 10) * (down + 10);
  const Size size = size_of(shape);
  Work work;
  work.kind = WorkKind::gather;
  work[OpClass::int_add] = matches * (positions * 121 * 3 + positions + 12);
  work[OpClass::int_mul] = matches * 4;
  work[OpClass::int_special] = matches * 2;
  const std::uint64_t lists = queries * 8 + matches * (8 + 32);
  work.read_issued = queries * 4 + matches * (36 + 121 + window);
  work.read_unique =
      lists + std::min(matches * (121 + window), 2 * (pixels(size) + pixels(level_size(size, 1))));
  work.written_issued = work.written_unique = queries * 16;
  if (variant == Variant::cpu) work.read_issued = lists + matches * 11 * 16 * (1 + positions);
  if (variant == Variant::gpu) {
    // All 32 work-items look up the match and both keypoints.
    work.read_issued = 32 * (queries * 4 + matches * 36) + matches * (121 + window);
    work.local_bytes = matches * (121 + window + positions * (242 + 4) + positions * 4);
  }
  if (variant == Variant::fpga) {
    // Per match the rows of the window, one offset per cycle, and the filling of both pipelines;
    // per query the look-up whether it is unique.
    work.add_loop(matches, static_cast<std::uint32_t>(down + 10 + positions) + 50, 0);
    work.add_loop(queries, 8, 0);
  }
  return work;
}

KernelCase refine_case(const Shape& shape, std::uint32_t seed) {
  const Size size = size_of(shape);
  const auto count = static_cast<std::size_t>(shape["queries"]);
  Random random(seed);
  const GrayImage a0 = textured_image(size, seed);
  const GrayImage b0 = moved_image(a0, -2, shape["range_y"] > 0 ? 1 : 0);
  const GrayImage a1 = golden::pyramid_down(a0);
  const GrayImage b1 = golden::pyramid_down(b0);
  std::vector<Keypoint> from(count);
  std::vector<Keypoint> to(count);
  std::vector<Match> matches(count);
  std::vector<Match> inverse(count);
  std::int64_t unique = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int level = random.between(0, 1);
    const Size level_of = level_size(size, level);
    const auto keypoint = [&](int x, int y) {
      x = std::clamp(x, kBorder, level_of.width - kBorder - 1);
      y = std::clamp(y, kBorder, level_of.height - kBorder - 1);
      return Keypoint{to_original_q8(x, level), to_original_q8(y, level), x | (y << 16),
                      level << 16};
    };
    const int x = random.between(kBorder, level_of.width - kBorder - 1);
    const int y = random.between(kBorder, level_of.height - kBorder - 1);
    from[i] = keypoint(x, y);
    to[i] = keypoint(x + random.between(-4, 3), y + random.between(-1, 1));
    matches[i] = {random.next() % 6 == 0 ? -1 : static_cast<int>(i), 10};
    inverse[i] = {random.next() % 6 == 0 ? -1 : static_cast<int>(i), 10};
    unique += matches[i].index >= 0 && inverse[i].index >= 0 ? 1 : 0;
  }
  return {
      shape.with("matches", unique),
      {bytes_of(a0), bytes_of(a1), bytes_of(b0), bytes_of(b1),
       array_of<Keypoint>(from, ElementType::i32), array_of<Keypoint>(to, ElementType::i32),
       array_of<Match>(matches, ElementType::i32), array_of<Match>(inverse, ElementType::i32),
       HostArray(ElementType::i32, count * 4), scalar(size.width), scalar(static_cast<int>(count)),
       scalar(static_cast<int>(shape["range_x"])), scalar(static_cast<int>(shape["range_y"])),
       scalar(shape["range_y"] > 0 ? 0 : 1), scalar(seed % 2 == 0 ? 30855 : 1500)}};
}

void refine_golden(KernelCase& c) {
  const Size size = size_of(c.shape);
  const auto count = static_cast<std::size_t>(c.shape["queries"]);
  std::vector<GrayImage> images;
  for (int i = 0; i < 4; ++i) {
    images.push_back(image_of(c.args[static_cast<std::size_t>(i)], level_size(size, i % 2)));
  }
  const std::span<const GrayImage> all(images);
  const golden::RefineOptions options{value_of(c.args[11]), value_of(c.args[12]),
                                      value_of(c.args[13]) != 0, value_of(c.args[14])};
  const auto refined = golden::refine_sad(
      all.first(2), all.last(2), records_of<Keypoint>(c.args[4], count),
      records_of<Keypoint>(c.args[5], count), records_of<Match>(c.args[6], count),
      records_of<Match>(c.args[7], count), options);
  assign_records<RefinedMatch>(c.args[8], refined);
}

KernelSpec make_refine() {
  KernelSpec spec;
  spec.name = spec.source = "refine_sad";
  spec.gpu_local_bytes = 4 * (121 + 27 * 19 + 153 * 4);
  spec.task = "frontend";
  spec.variants = kAllVariants;
  for (const char* name : {"a0", "a1", "b0", "b1"}) {
    spec.args.push_back({name, Access::in, ElementType::u8});
  }
  for (const char* name : {"keypoints_a", "keypoints_b", "matches", "inverse"}) {
    spec.args.push_back({name, Access::in, ElementType::i32});
  }
  spec.args.push_back({"refined_matches", Access::out, ElementType::i32});
  for (const char* name : {"width", "count", "range_x", "range_y", "same_row", "max_sad"}) {
    spec.args.push_back({name, Access::scalar, ElementType::i32});
  }
  spec.geometry = [](Variant variant, const Shape& shape) {
    return feature_geometry(variant, shape["queries"], 16);
  };
  spec.work = refine_work;
  // Both patches in registers, the costs in a memory; 121 differences with their sum side by side.
  spec.design =
      design({{1, 968, 1, 2}, {1, 4104, 1, 2}, {153, 32, 1, 2}},
             {{OpClass::int_mul, 6}, {OpClass::int_special, 2}, {OpClass::int_add, 363}}, 10, 3);
  spec.make_case = refine_case;
  spec.golden = refine_golden;
  const auto shape = [](std::int64_t width, std::int64_t height, std::int64_t queries,
                        std::int64_t range_x, std::int64_t range_y) {
    return Shape{{"width", width},     {"height", height},   {"queries", queries},
                 {"matches", queries}, {"range_x", range_x}, {"range_y", range_y}};
  };
  spec.small_shapes = {shape(64, 64, 5, 5, 0), shape(70, 65, 6, 2, 2), shape(64, 80, 2, 8, 4)};
  spec.shapes = {shape(64, 64, 100, 1, 0), shape(333, 99, 300, 8, 4), shape(1226, 370, 1200, 5, 0),
                 shape(1280, 720, 2000, 2, 2)};
  return spec;
}

}  // namespace

const KernelSpec& invert_matches_spec() {
  static const KernelSpec spec = make_invert();
  return spec;
}

const KernelSpec& refine_sad_spec() {
  static const KernelSpec spec = make_refine();
  return spec;
}

}  // namespace partita::frontend
