#include "host/tasks/frontend/program.h"

#include "host/tasks/frontend/kernels.h"
#include "host/tasks/frontend/layout.h"
#include "host/tasks/frontend/shapes.h"

namespace partita::frontend {
namespace {

std::uint64_t bytes_of(int count, std::size_t each) {
  return static_cast<std::uint64_t>(count) * each;
}

/// The frame's steps in order; its functions are those of Extractor, Associator and Frontend.
class FrameProgram {
 public:
  FrameProgram(const Grids& grids, const FrontendParameters& parameters)
      : grids_(grids), parameters_(parameters) {}

  tasks::Program build(const FrameCounts& counts) {
    detect();
    detect();
    program_.read(sizeof(std::int32_t));  // how many features there are, left and right
    program_.read(sizeof(std::int32_t));
    describe(counts.keypoints_left);
    describe(counts.keypoints_right);
    stereo(counts.keypoints_left, counts.keypoints_right);
    if (counts.keypoints_left > 0) {
      program_.read(bytes_of(counts.keypoints_left, sizeof(Keypoint)));
    }
    for (const SearchCounts& search : counts.searches) track(counts, search);
    return std::move(program_);
  }

 private:
  void detect() {
    const Size size = grids_.size;
    program_.write(static_cast<std::uint64_t>(size.pixels()));
    program_.launch(pyramid_down_spec(), image_shape(size));
    for (int level = 0; level < kLevels; ++level) {
      const Size own = level_size(size, level);
      program_.launch(fast_score_spec(), image_shape(own));
      program_.launch(select_cells_spec(), select_shape(own, grids_.at(level)));
    }
    program_.launch(compact_spec(), compact_shape(grids_));
    for (int level = 0; level < kLevels; ++level) {
      program_.launch(gaussian_blur_spec(), image_shape(level_size(size, level)));
    }
  }

  void describe(int keypoints) {
    if (keypoints > 0) program_.launch(describe_spec(), describe_shape(grids_, keypoints));
  }

  void refine(int queries, int trains, const SadRange& range) {
    program_.launch(refine_sad_spec(), refine_shape(grids_, queries, trains, range));
    program_.read(bytes_of(queries, sizeof(RefinedMatch)));
  }

  void stereo(int left, int right) {
    if (left == 0 || right == 0) return;
    program_.launch(match_window_spec(),
                    match_shape(grids_, left, right, stereo_window(parameters_, true), left));
    program_.launch(match_window_spec(),
                    match_shape(grids_, right, left, stereo_window(parameters_, false), right));
    refine(left, right, kStereoRange);
  }

  void track(const FrameCounts& counts, const SearchCounts& search) {
    const int from = counts.reference, to = counts.keypoints_left;
    program_.host(predict_spec(), predict_shape(from));
    if (search.searched > 0 && to > 0) {
      program_.write(bytes_of(from, sizeof(Shift)));
      program_.launch(match_window_spec(),
                      match_shape(grids_, from, to, temporal_window(parameters_, search.wide),
                                  search.searched));
      program_.launch(invert_matches_spec(), invert_shape(from, to));
      refine(from, to, kTemporalRange);
    }
    program_.host(motion_spec(), motion_shape(search));
  }

  const Grids& grids_;
  const FrontendParameters& parameters_;
  tasks::Program program_;
};

}  // namespace

tasks::Program program(int width, int height, const FrontendParameters& parameters,
                       const FrameCounts& counts) {
  const Grids grids = make_grids({width, height}, parameters.max_features);
  return FrameProgram(grids, parameters).build(counts);
}

FrameCounts typical_counts(int width, int height, const FrontendParameters& parameters) {
  const int capacity = make_grids({width, height}, parameters.max_features).capacity();
  const int keypoints = capacity * 3 / 4;
  const auto share = [keypoints](int percent) { return keypoints * percent / 100; };
  return {.keypoints_left = keypoints,
          .keypoints_right = keypoints,
          .reference = keypoints,
          .searches = {{.searched = share(46),
                        .matches = share(27),
                        .hypotheses = parameters.ransac_hypotheses + 1,  // the prediction is one
                        .inliers = share(25),
                        .iterations = 9}}};
}

tasks::TaskExport export_task(int width, int height, const FrontendParameters& parameters,
                              std::span<const FrameCounts> frames) {
  tasks::TaskExport task{.name = "frontend", .kernels = kernel_specs()};
  std::uint64_t features = 0;
  for (const FrameCounts& counts : frames) {
    task.frames.push_back(program(width, height, parameters, counts));
    features += static_cast<std::uint64_t>(counts.keypoints_left);
  }
  // The mean frame's features, and the pose as a 3 x 4 matrix.
  const std::uint64_t mean = frames.empty() ? 0 : features / frames.size();
  task.outputs = {{"features", mean * sizeof(Feature) + 12 * sizeof(double)}};
  return task;
}

}  // namespace partita::frontend
