// Spec of match_window, and the list of all specs.
#include <algorithm>

#include "host/tasks/frontend/cases.h"
#include "host/tasks/frontend/kernels.h"
#include "host/tasks/frontend/spec_tools.h"

namespace partita::frontend {
namespace {

using golden::Descriptor;
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

Work match_work(Variant variant, const Shape& shape) {
  const auto count = [&shape](const char* name) { return static_cast<std::uint64_t>(shape[name]); };
  const std::uint64_t queries = count("queries");
  const std::uint64_t trains = count("trains");
  const std::uint64_t searched = count("searched");
  const std::uint64_t rows = count("rows");
  const std::uint64_t visited = count("visited");
  const std::uint64_t candidates = count("candidates");
  const Size size = size_of(shape);
  const int cell0 = static_cast<int>(shape["cell0"]);
  const int cell1 = static_cast<int>(shape["cell1"]);
  const auto cells = static_cast<std::uint64_t>(make_grid(size, cell0).cells() +
                                                make_grid(level_size(size, 1), cell1).cells());
  // Visited: four comparisons with the window. Candidates: 256 bits xor-ed and counted word by
  // word, and the running best and second. A query: its window and the cells of it.
  Work work;
  work.kind = WorkKind::gather;
  work[OpClass::int_add] = visited * 4 + candidates * (103 + 6) + searched * 30;
  work[OpClass::int_mul] = candidates * 8;
  work[OpClass::int_special] = searched * 4;
  work.written_issued = work.written_unique = queries * 8;
  work.read_unique = queries * 56 + std::min(trains, visited) * 48 + cells * 4;
  // On the GPU all 32 work-items of a query read the query and the runs' ends.
  const std::uint64_t lanes = variant == Variant::gpu ? 32 : 1;
  work.read_issued =
      lanes * (queries * 8 + searched * 48 + rows * 8) + visited * 16 + candidates * 32;
  if (variant == Variant::gpu) work.local_bytes = queries * (32 * 8 + 31 * 16);
  if (variant == Variant::fpga) {
    work[OpClass::int_add] = visited * (4 + 103 + 6) + queries * 30;  // distances of all visited
    work[OpClass::int_mul] = visited * 8;
    work.read_issued = work.read_unique = queries * 56 + trains * 40 + cells * 4;
    work.add_loop(cells + 1, 1, 30);
    work.add_loop(trains, 2, 30);   // 48 bytes on a port of 32 bytes a cycle
    work.add_loop(queries, 40, 0);  // fetching a query, finding its cells
    work.add_loop(rows, 12, 0);     // filling the pipeline for every run
    work.add_loop(visited, 1, 0);   // carried: a minimum and a select
  }
  return work;
}

/// What a search visits: the runs of cells (one per grid row) and the features in them.
struct Visits {
  std::int64_t rows = 0;
  std::int64_t features = 0;
  std::int64_t candidates = 0;
};

/// First and last cell in one direction that can hold positions of least..most (q8, original).
std::pair<int, int> cells_between(int least, int most, int level, int cell, int cells) {
  const auto to_level = [level](int q8) {
    return level == 0 ? q8 >> 8 : std::max(q8, 0) * 5 / 1536 - 1;
  };
  const int first = std::max(to_level(least) - kBorder, 0) / cell;
  const int behind = to_level(most) + 2 - kBorder;
  return {first, behind < 0 ? -1 : std::min(behind / cell, cells - 1)};
}

void count_visits(const Keypoint& query, Shift shift, const Window& window,
                  std::span<const Keypoint> trains, const Grid& grid, Visits& visits) {
  const int x = query.x_q8 + shift.x_q8;
  const int y = query.y_q8 + shift.y_q8;
  const auto [column0, column1] =
      cells_between(x + window.x_least, x + window.x_most, query.level(), grid.cell, grid.columns);
  const auto [row0, row1] =
      cells_between(y + window.y_least, y + window.y_most, query.level(), grid.cell, grid.rows);
  if (column0 > column1) return;
  visits.rows += std::max(0, row1 - row0 + 1);
  for (const Keypoint& train : trains) {
    const int column = (train.x() - kBorder) / grid.cell;
    const int row = (train.y() - kBorder) / grid.cell;
    if (train.level() != query.level() || column < column0 || column > column1 || row < row0 ||
        row > row1) {
      continue;
    }
    ++visits.features;
    const int dx = train.x_q8 - x;
    const int dy = train.y_q8 - y;
    visits.candidates +=
        dx >= window.x_least && dx <= window.x_most && dy >= window.y_least && dy <= window.y_most;
  }
}

/// The queries resemble the features to search: moved, some bits flipped, some not to be matched.
KernelCase match_case(const Shape& shape, std::uint32_t seed) {
  const Size size = size_of(shape);
  const int cell0 = static_cast<int>(shape["cell0"]);
  const int cell1 = static_cast<int>(shape["cell1"]);
  Random random(seed);
  const Grid grid0 = make_grid(size, cell0);
  const Grid grid1 = make_grid(level_size(size, 1), cell1);
  const auto list = random_features(size, grid0, grid1, random);
  const auto train_descriptors = random_descriptors(list.keypoints.size(), random);
  const auto window = seed % 2 == 0 ? Window{-60 * 256, 0, -2 * 256, 2 * 256}
                                    : Window{-24 * 256, 24 * 256, -24 * 256, 24 * 256};
  std::vector<Keypoint> queries = list.keypoints;
  std::vector<Descriptor> query_descriptors = train_descriptors;
  std::vector<Shift> shifts(queries.size());
  Visits visits;
  std::int64_t searched = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    queries[i].x_q8 += random.between(-10 * 256, 30 * 256);
    queries[i].y_q8 += random.between(-3 * 256, 3 * 256);
    query_descriptors[i][i % 8] ^= random.next() & random.next();
    query_descriptors[i][(i + 3) % 8] ^= i % 3 == 0 ? 0xFFFFFFFFu : 0u;
    if (random.next() % 8 == 0) {
      shifts[i] = {kNoPrediction, 0};
      continue;
    }
    shifts[i] = {random.between(-512, 512), random.between(-512, 512)};
    ++searched;
    count_visits(queries[i], shifts[i], window, list.keypoints,
                 queries[i].level() == 0 ? grid0 : grid1, visits);
  }
  const auto count = static_cast<std::int64_t>(queries.size());
  const Shape counted = shape.with("queries", count)
                            .with("trains", count)
                            .with("searched", searched)
                            .with("rows", visits.rows)
                            .with("visited", visits.features)
                            .with("candidates", visits.candidates);
  return {counted,
          {array_of<Keypoint>(queries, ElementType::i32),
           array_of<Descriptor>(query_descriptors, ElementType::u32),
           array_of<Shift>(shifts, ElementType::i32),
           array_of<Keypoint>(list.keypoints, ElementType::i32),
           array_of<Descriptor>(train_descriptors, ElementType::u32),
           array_of<std::int32_t>(list.cell_start, ElementType::i32),
           HostArray(ElementType::i32, queries.size() * 2), scalar(static_cast<int>(count)),
           scalar(size.width), scalar(size.height), scalar(cell0), scalar(cell1),
           scalar(window.x_least), scalar(window.x_most), scalar(window.y_least),
           scalar(window.y_most), scalar(80), scalar(seed % 3 == 0 ? 256 : 200)}};
}

void match_golden(KernelCase& c) {
  const auto queries = static_cast<std::size_t>(c.shape["queries"]);
  const auto trains = static_cast<std::size_t>(c.shape["trains"]);
  const Window window{value_of(c.args[12]), value_of(c.args[13]), value_of(c.args[14]),
                      value_of(c.args[15])};
  const auto matches = golden::match_window(
      records_of<Keypoint>(c.args[0], queries), records_of<Descriptor>(c.args[1], queries),
      records_of<Shift>(c.args[2], queries), records_of<Keypoint>(c.args[3], trains),
      records_of<Descriptor>(c.args[4], trains), window, value_of(c.args[16]),
      value_of(c.args[17]));
  assign_records<Match>(c.args[6], matches);
}

KernelSpec make_match() {
  KernelSpec spec;
  spec.name = spec.source = "match_window";
  spec.gpu_local_bytes = 4 * 32 * 8;
  spec.task = "frontend";
  spec.variants = kAllVariants;
  spec.args = {{"queries", Access::in, ElementType::i32},
               {"query_descriptors", Access::in, ElementType::u32},
               {"shifts", Access::in, ElementType::i32},
               {"trains", Access::in, ElementType::i32},
               {"train_descriptors", Access::in, ElementType::u32},
               {"cell_start", Access::in, ElementType::i32},
               {"matches", Access::out, ElementType::i32}};
  for (const char* name : {"query_count", "width", "height", "cell0", "cell1", "x_least", "x_most",
                           "y_least", "y_most", "max_hamming", "ratio_q8"}) {
    spec.args.push_back({name, Access::scalar, ElementType::i32});
  }
  spec.geometry = [](Variant variant, const Shape& shape) {
    return feature_geometry(variant, shape["queries"], 32);
  };
  spec.work = match_work;
  spec.design = design({{2048, 64, 1, 2}, {2048, 256, 1, 2}, {513, 32, 1, 2}},
                       {{OpClass::int_special, 8}, {OpClass::int_add, 160}}, 16, 3);
  spec.make_case = match_case;
  spec.golden = match_golden;
  const auto shape = [](std::int64_t width, std::int64_t height, std::int64_t cell0,
                        std::int64_t cell1) {
    return Shape{{"width", width}, {"height", height}, {"cell0", cell0}, {"cell1", cell1}};
  };
  spec.small_shapes = {shape(64, 64, 30, 20), shape(90, 70, 16, 30)};
  spec.shapes = {shape(301, 64, 8, 8), shape(1226, 370, 38, 36), shape(1280, 720, 56, 56)};
  return spec;
}

}  // namespace

const KernelSpec& match_window_spec() {
  static const KernelSpec spec = make_match();
  return spec;
}

std::vector<const KernelSpec*> kernel_specs() {
  return {&pyramid_down_spec(), &fast_score_spec(),     &gaussian_blur_spec(),
          &select_cells_spec(), &compact_spec(),        &describe_spec(),
          &match_window_spec(), &invert_matches_spec(), &refine_sad_spec()};
}

}  // namespace partita::frontend
