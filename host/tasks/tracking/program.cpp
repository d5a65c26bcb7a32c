#include "host/tasks/tracking/program.h"

#include <algorithm>

#include "host/tasks/tracking/kernels.h"
#include "host/tasks/tracking/shapes.h"
#include "host/tasks/tracking/windows.h"

namespace partita::tracking {
namespace {

constexpr std::uint64_t kTrackBytes = 40;  ///< box, velocity, class, identity, score

/// The frame's steps in order; its functions are those of Tracker and Filters.
class FrameProgram {
 public:
  FrameProgram(Picture size, const FilterParameters& parameters, const FrameCounts& counts)
      : size_(size),
        scales_(parameters.scales),
        cells_(parameters.template_side / kCell),
        counts_(counts) {}

  tasks::Program build() {
    program_.write(static_cast<std::uint64_t>(size_.width) *
                   static_cast<std::uint64_t>(size_.height));
    if (counts_.located > 0) locate();
    if (counts_.detected) {
      program_.host(associate_spec(), associate_shape(counts_.tracks, counts_.detections));
    }
    if (counts_.trained > 0) train();
    program_.finish();
    return std::move(program_);
  }

 private:
  void extract(std::int64_t patches, std::int64_t samples) {
    program_.launch(resample_spec(), resample_shape(size_, cells_, patches, samples));
    program_.launch(cell_histograms_spec(), patches_shape(cells_, patches));
    program_.launch(cell_features_spec(), patches_shape(cells_, patches));
    program_.launch(spectra_spec(), planes_shape(cells_, patches * kChannels));
  }

  void locate() {
    const std::int64_t patches = counts_.located * scales_;
    program_.write(static_cast<std::uint64_t>(patches) * sizeof(Window));
    program_.write(static_cast<std::uint64_t>(counts_.located) * sizeof(std::int32_t));
    extract(patches, counts_.locate_samples);
    program_.launch(correlate_spec(), scales_shape(cells_, patches, scales_));
    program_.launch(respond_spec(), scales_shape(cells_, patches, scales_));
    program_.read(static_cast<std::uint64_t>(patches) * kPeakEntries * sizeof(float));
    program_.host(locate_spec(), locate_shape(counts_.located, patches));
  }

  void train() {
    const auto targets = static_cast<std::uint64_t>(counts_.trained);
    program_.write(targets * sizeof(Window));
    program_.write(targets * sizeof(std::int32_t));
    program_.write(targets * sizeof(float));
    extract(counts_.trained, counts_.train_samples);
    program_.launch(correlate_spec(), scales_shape(cells_, counts_.trained, 1));
    program_.launch(train_spec(), train_shape(cells_, counts_.trained));
  }

  Picture size_;
  int scales_;
  int cells_;
  const FrameCounts& counts_;
  tasks::Program program_;
};

}  // namespace

tasks::Program program(int width, int height, const FilterParameters& parameters,
                       const FrameCounts& counts) {
  return FrameProgram({width, height}, parameters, counts).build();
}

FrameCounts typical_counts(const FilterParameters& parameters) {
  constexpr std::int64_t kTargets = 10;
  constexpr std::int64_t kTaps = 4;
  const std::int64_t samples =
      kTargets * kTaps * parameters.template_side * parameters.template_side;
  return {.located = kTargets,
          .locate_samples = samples * parameters.scales,
          .detected = true,
          .tracks = kTargets,
          .detections = 2 * kTargets,
          .trained = kTargets,
          .train_samples = samples};
}

tasks::TaskExport export_task(int width, int height, const FilterParameters& parameters,
                              std::span<const FrameCounts> frames) {
  tasks::TaskExport task{.name = "tracking", .kernels = kernel_specs()};
  std::int64_t tracks = 0;
  for (const FrameCounts& counts : frames) {
    task.frames.push_back(program(width, height, parameters, counts));
    tracks = std::max(tracks, counts.trained);
  }
  task.outputs = {{"tracks", static_cast<std::uint64_t>(tracks) * kTrackBytes}};
  return task;
}

}  // namespace partita::tracking
