#include "host/tasks/depth/program.h"

#include "host/tasks/depth/kernels.h"
#include "host/tasks/depth/planes.h"
#include "host/tasks/depth/shapes.h"

namespace partita::depth {
namespace {

std::uint64_t bytes_of(std::int64_t count, std::size_t each) {
  return static_cast<std::uint64_t>(count) * each;
}

/// The frame's steps in order; its functions are those of Depth.
class FrameProgram {
 public:
  FrameProgram(Size size, const DepthParameters& parameters, const FrameCounts& counts)
      : size_(size),
        grid_(grid_size(size, parameters.candidate_step)),
        parameters_(parameters),
        counts_(counts) {}

  tasks::Program build() {
    describe();
    describe();
    find_support();
    list_support();
    for (const bool right : {false, true}) {
      program_.launch(grid_seen_spec(), grid_seen_shape(size_, parameters_, right));
      program_.launch(grid_prior_spec(), grid_prior_shape(size_, parameters_));
      program_.read_later(area(cell_size(size_, parameters_.grid_size)) * sizeof(std::uint16_t));
    }
    const bool meshed = triangulate(counts_.views[0]) && triangulate(counts_.views[1]);
    program_.finish();
    if (!meshed) return std::move(program_);
    for (const bool right : {false, true}) match(right);
    program_.launch(consistency_spec(), picture_shape(size_));
    post_process();
    program_.read(area(size_) * sizeof(std::uint16_t));
    return std::move(program_);
  }

 private:
  void describe() {
    program_.write(area(size_));
    program_.launch(sobel_spec(), picture_shape(size_));
    program_.launch(descriptor_spec(), picture_shape(size_));
  }

  void find_support() {
    program_.launch(support_match_spec(), support_match_shape(size_, parameters_));
    program_.launch(support_plausible_spec(), plausible_shape(grid_, parameters_));
    program_.copy(area(grid_) * sizeof(std::int16_t));
    for (const int vertical : {1, 0}) {
      program_.launch(support_redundant_spec(), redundant_shape(grid_, parameters_, vertical));
    }
  }

  void list_support() {
    program_.launch(support_list_spec(), support_list_shape(grid_));
    program_.read(sizeof(std::uint32_t));
    if (counts_.support_points > 0) {
      program_.read(bytes_of(counts_.support_points, sizeof(SupportPoint)));
    }
  }

  bool triangulate(const ViewCounts& view) {
    program_.host(triangulation_spec(), triangulation_shape(counts_, view));
    if (view.triangles == 0) return false;
    program_.write(bytes_of(view.triangles, kCornerEntries * sizeof(std::int16_t)));
    program_.write(bytes_of(view.triangles, kPlaneEntries * sizeof(std::int32_t)));
    return true;
  }

  void match(bool right) {
    const ViewCounts& view = counts_.views[right ? 1 : 0];
    program_.launch(plane_prior_spec(), plane_prior_shape(size_, view));
    program_.launch(dense_match_spec(), dense_match_shape(size_, parameters_, view, right));
  }

  void post_process() {
    const DepthParameters& p = parameters_;
    if (p.speckle_size > 1) {
      program_.launch(segments_spec(), picture_shape(size_));
      program_.launch(join_segments_spec(), picture_shape(size_));
      program_.launch(remove_speckles_spec(), picture_shape(size_));
    }
    if (p.ipol_gap_width > 0) {
      for (const int vertical : {0, 1}) {
        program_.launch(fill_gaps_spec(), fill_gaps_shape(size_, p, vertical));
      }
    }
    if (p.filter_adaptive_mean) filter(adaptive_mean_spec());
    if (p.filter_median) filter(median_spec());
  }

  void filter(const runtime::KernelSpec& spec) {
    for (const int vertical : {0, 1}) program_.launch(spec, filter_shape(size_, vertical));
  }

  Size size_;
  Size grid_;
  const DepthParameters& parameters_;
  const FrameCounts& counts_;
  tasks::Program program_;
};

}  // namespace

tasks::Program program(int width, int height, const DepthParameters& parameters,
                       const FrameCounts& counts) {
  return FrameProgram({width, height}, parameters, counts).build();
}

FrameCounts typical_counts(int width, int height, const DepthParameters& parameters) {
  const Size size{width, height};
  const auto pixels = static_cast<std::int64_t>(area(size));
  const auto points = static_cast<std::int64_t>(area(grid_size(size, parameters.candidate_step)));
  FrameCounts counts;
  counts.support_points = points * 117 / 1000;
  for (ViewCounts& view : counts.views) {
    view.triangles = counts.support_points * 198 / 100;
    view.covered = pixels * 90 / 100;
    view.spans = view.triangles * 15;
    view.overlaps = view.triangles * 19 / 10;
    view.entries = pixels * 11;
  }
  return counts;
}

tasks::TaskExport export_task(int width, int height, const DepthParameters& parameters,
                              std::span<const FrameCounts> frames) {
  tasks::TaskExport task{.name = "depth", .kernels = kernel_specs()};
  for (const FrameCounts& counts : frames) {
    task.frames.push_back(program(width, height, parameters, counts));
  }
  task.outputs = {{"disparity", area({width, height}) * sizeof(std::uint16_t)}};
  return task;
}

}  // namespace partita::depth
