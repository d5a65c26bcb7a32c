#include "host/tasks/frontend/associator.h"

#include <algorithm>
#include <span>

#include "host/tasks/frontend/kernels.h"

namespace partita::frontend {
namespace {

constexpr int kStereoRange = 5;  ///< pixels of the level, either side
constexpr int kTemporalRange = 2;
constexpr int kNoRatio = 256;  ///< both directions agree: that is the test of uniqueness

/// What the searches of a window meet if features lie evenly over both levels.
runtime::Shape with_expected_visits(const runtime::Shape& shape, std::int64_t searched,
                                    const Window& window) {
  const double cell = static_cast<double>(shape["cell0"]);
  const double across = (window.x_most - window.x_least) / 256.0 + 1;
  const double down = (window.y_most - window.y_least) / 256.0 + 1;
  const double per_pixel = static_cast<double>(shape["trains"]) / 2 /
                           static_cast<double>(shape["width"] * shape["height"]);
  const auto count = [searched](double per_query) {
    return static_cast<std::int64_t>(static_cast<double>(searched) * per_query);
  };
  return shape.with("searched", searched)
      .with("rows", count(down / cell + 1))
      .with("visited", count((across + cell) * (down + cell) * per_pixel))
      .with("candidates", count(across * down * per_pixel));
}

}  // namespace

Associator::Associator(const runtime::Session& session, const Extractor& extractor,
                       const FrontendParameters& parameters)
    : session_(session),
      extractor_(extractor),
      parameters_(parameters),
      match_window_(session, match_window_spec()),
      invert_matches_(session, invert_matches_spec()),
      refine_sad_(session, refine_sad_spec()) {
  const auto capacity = static_cast<std::size_t>(extractor.capacity());
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
  const int cell0 = extractor_.grid(0).cell;
  const int cell1 = extractor_.grid(1).cell;
  const runtime::Shape shape{
      {"width", size.width}, {"height", size.height},       {"cell0", cell0},
      {"cell1", cell1},      {"queries", queries.features}, {"trains", trains.features}};
  match_window_.launch(with_expected_visits(shape, searched, window), queries.keypoints,
                       queries.descriptors, shifts, trains.keypoints, trains.descriptors,
                       trains.cell_start, matches, queries.features, size.width, size.height, cell0,
                       cell1, window.x_least, window.x_most, window.y_least, window.y_most,
                       max_hamming, ratio_q8);
}

std::vector<RefinedMatch> Associator::refine(const DeviceFeatures& a, const DeviceFeatures& b,
                                             int range_x, int range_y, bool same_row) {
  const Size size = extractor_.size();
  const runtime::Shape shape{
      {"width", size.width},   {"height", size.height},
      {"queries", a.features}, {"matches", std::min(a.features, b.features) / 2},
      {"range_x", range_x},    {"range_y", range_y}};
  refine_sad_.launch(shape, a.images[0], a.images[1], b.images[0], b.images[1], a.keypoints,
                     b.keypoints, forward_, backward_, refined_, size.width, a.features, range_x,
                     range_y, same_row ? 1 : 0, parameters_.max_sad);
  std::vector<RefinedMatch> result(static_cast<std::size_t>(a.features));
  session_.read(refined_, std::as_writable_bytes(std::span(result)));
  return result;
}

std::vector<RefinedMatch> Associator::stereo(const DeviceFeatures& left,
                                             const DeviceFeatures& right) {
  if (left.features == 0 || right.features == 0) {
    return std::vector<RefinedMatch>(static_cast<std::size_t>(left.features));
  }
  const int band = parameters_.stereo_band * 256;
  const int largest = parameters_.max_disparity * 256;
  match(left, right, no_shifts_, {-largest, 0, -band, band}, parameters_.max_hamming, kNoRatio,
        forward_, left.features);
  match(right, left, no_shifts_, {0, largest, -band, band}, parameters_.max_hamming, kNoRatio,
        backward_, right.features);
  return refine(left, right, kStereoRange, 0, true);
}

std::vector<RefinedMatch> Associator::temporal(const DeviceFeatures& from, const DeviceFeatures& to,
                                               const std::vector<Shift>& shifts, int window) {
  const auto searched = std::count_if(
      shifts.begin(), shifts.end(), [](const Shift& shift) { return shift.x_q8 != kNoPrediction; });
  if (searched == 0 || to.features == 0) {
    return std::vector<RefinedMatch>(static_cast<std::size_t>(from.features));
  }
  session_.write(shifts_, std::as_bytes(std::span(shifts)));
  const int reach = window * 256;
  match(from, to, shifts_, {-reach, reach, -reach, reach}, parameters_.max_hamming,
        parameters_.ratio_q8, forward_, static_cast<int>(searched));
  invert_matches_.launch({{"queries", from.features}, {"trains", to.features}}, forward_, backward_,
                         from.features, to.features);
  return refine(from, to, kTemporalRange, kTemporalRange, false);
}

}  // namespace partita::frontend
