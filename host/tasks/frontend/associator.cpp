#include "host/tasks/frontend/associator.h"

#include <span>

#include "host/tasks/frontend/kernels.h"
#include "host/tasks/frontend/shapes.h"

namespace partita::frontend {
namespace {

constexpr int kNoRatio = 256;  ///< both directions agree: that is the test of uniqueness

}  // namespace

Associator::Associator(const runtime::Session& session, const Extractor& extractor,
                       const FrontendParameters& parameters)
    : session_(session),
      extractor_(extractor),
      parameters_(parameters),
      match_window_(session, match_window_spec()),
      invert_matches_(session, invert_matches_spec()),
      refine_sad_(session, refine_sad_spec()) {
  const auto capacity = static_cast<std::size_t>(extractor.grids().capacity());
  no_shifts_ = session.make_buffer(capacity * sizeof(Shift), CL_MEM_READ_ONLY);
  shifts_ = session.make_buffer(capacity * sizeof(Shift), CL_MEM_READ_ONLY);
  forward_ = session.make_buffer(capacity * sizeof(Match));
  backward_ = session.make_buffer(capacity * sizeof(Match));
  refined_ = session.make_buffer(capacity * sizeof(RefinedMatch));
  const std::vector<Shift> zeros(capacity);
  session.write(no_shifts_, std::as_bytes(std::span(zeros)));
  session.finish();
}

void Associator::match(const DeviceFeatures& queries, const DeviceFeatures& trains,
                       const cl::Buffer& shifts, const Window& window, int max_hamming,
                       int ratio_q8, const cl::Buffer& matches, int searched) {
  const Size size = extractor_.size();
  const Grids& grids = extractor_.grids();
  match_window_.launch(match_shape(grids, queries.features, trains.features, window, searched),
                       queries.keypoints, queries.descriptors, shifts, trains.keypoints,
                       trains.descriptors, trains.cell_start, matches, queries.features, size.width,
                       size.height, grids.at(0).cell, grids.at(1).cell, window.x_least,
                       window.x_most, window.y_least, window.y_most, max_hamming, ratio_q8);
}

std::vector<RefinedMatch> Associator::refine(const DeviceFeatures& a, const DeviceFeatures& b,
                                             const SadRange& range, bool same_row) {
  refine_sad_.launch(refine_shape(extractor_.grids(), a.features, b.features, range), a.images[0],
                     a.images[1], b.images[0], b.images[1], a.keypoints, b.keypoints, forward_,
                     backward_, refined_, extractor_.size().width, a.features, range.x, range.y,
                     same_row ? 1 : 0, parameters_.max_sad);
  std::vector<RefinedMatch> result(static_cast<std::size_t>(a.features));
  session_.read(refined_, std::as_writable_bytes(std::span(result)));
  return result;
}

std::vector<RefinedMatch> Associator::stereo(const DeviceFeatures& left,
                                             const DeviceFeatures& right) {
  if (left.features == 0 || right.features == 0) {
    return std::vector<RefinedMatch>(static_cast<std::size_t>(left.features));
  }
  match(left, right, no_shifts_, stereo_window(parameters_, true), parameters_.max_hamming,
        kNoRatio, forward_, left.features);
  match(right, left, no_shifts_, stereo_window(parameters_, false), parameters_.max_hamming,
        kNoRatio, backward_, right.features);
  return refine(left, right, kStereoRange, true);
}

std::vector<RefinedMatch> Associator::temporal(const DeviceFeatures& from, const DeviceFeatures& to,
                                               const std::vector<Shift>& shifts, int searched,
                                               bool wide) {
  if (searched == 0 || to.features == 0) {
    return std::vector<RefinedMatch>(static_cast<std::size_t>(from.features));
  }
  session_.write(shifts_, std::as_bytes(std::span(shifts)));
  match(from, to, shifts_, temporal_window(parameters_, wide), parameters_.max_hamming,
        parameters_.ratio_q8, forward_, searched);
  invert_matches_.launch(invert_shape(from.features, to.features), forward_, backward_,
                         from.features, to.features);
  return refine(from, to, kTemporalRange, false);
}

}  // namespace partita::frontend
