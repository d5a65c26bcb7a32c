#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/tasks/frontend/frontend.h"
#include "host/tasks/frontend/layout.h"

namespace partita::frontend {
namespace {

template <typename T>
void check(const char* name, T value, T least, T most) {
  if (value >= least && value <= most) return;  // a NaN is neither
  throw Error(fmt::format("frontend: {} is {}, expected {} to {}", name, value, least, most));
}

}  // namespace

void validate(const FrontendParameters& p) {
  check("max_features", p.max_features, 64, kMaxFeatures);
  check("fast_threshold", p.fast_threshold, 1, 254);
  check("fast_threshold_low", p.fast_threshold_low, 1, p.fast_threshold);
  check("stereo_band", p.stereo_band, 0, 16);
  check("max_disparity", p.max_disparity, 8, 1024);
  check("min_disparity", p.min_disparity, 0.25, 16.0);
  check("search_window", p.search_window, 4, 256);
  check("wide_search_window", p.wide_search_window, p.search_window, 256);
  check("max_hamming", p.max_hamming, 0, 256);
  check("ratio_q8", p.ratio_q8, 1, 256);
  check("max_sad", p.max_sad, 0, 30855);
  check("min_inliers", p.min_inliers, 6, 1000);
  check("ransac_hypotheses", p.ransac_hypotheses, 1, 10000);
  check("inlier_bound", p.inlier_bound, 0.1, 20.0);
}

}  // namespace partita::frontend
