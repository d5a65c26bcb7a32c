#include "host/tasks/frontend/shapes.h"

#include <algorithm>

namespace partita::frontend {

using runtime::Shape;

Window stereo_window(const FrontendParameters& parameters, bool forward) {
  const int band = parameters.stereo_band * 256;
  const int largest = parameters.max_disparity * 256;
  return forward ? Window{-largest, 0, -band, band} : Window{0, largest, -band, band};
}

Window temporal_window(const FrontendParameters& parameters, bool wide) {
  const int reach = (wide ? parameters.wide_search_window : parameters.search_window) * 256;
  return {-reach, reach, -reach, reach};
}

Shape image_shape(Size size) {
  return {{"width", size.width}, {"height", size.height}};
}

Shape select_shape(Size size, const Grid& grid) {
  return image_shape(size).with("cell", grid.cell);
}

Shape compact_shape(const Grids& grids) {
  return {{"cells", grids.cells()}, {"keypoints", grids.capacity() / 2}};
}

Shape describe_shape(const Grids& grids, int keypoints) {
  return image_shape(grids.size).with("keypoints", keypoints);
}

Shape match_shape(const Grids& grids, int queries, int trains, const Window& window, int searched) {
  const Size size = grids.size;
  const double cell = grids.level[0].cell;
  const double across = (window.x_most - window.x_least) / 256.0 + 1;
  const double down = (window.y_most - window.y_least) / 256.0 + 1;
  const double per_pixel = static_cast<double>(trains) / 2 / static_cast<double>(size.pixels());
  const auto count = [searched](double per_query) {
    return static_cast<std::int64_t>(static_cast<double>(searched) * per_query);
  };
  return {{"width", size.width},
          {"height", size.height},
          {"cell0", grids.level[0].cell},
          {"cell1", grids.level[1].cell},
          {"queries", queries},
          {"trains", trains},
          {"searched", searched},
          {"rows", count(down / cell + 1)},
          {"visited", count((across + cell) * (down + cell) * per_pixel)},
          {"candidates", count(across * down * per_pixel)}};
}

Shape invert_shape(int queries, int trains) {
  return {{"queries", queries}, {"trains", trains}};
}

Shape refine_shape(const Grids& grids, int queries, int trains, const SadRange& range) {
  return {{"width", grids.size.width}, {"height", grids.size.height},
          {"queries", queries},        {"matches", std::min(queries, trains) / 2},
          {"range_x", range.x},        {"range_y", range.y}};
}

Shape predict_shape(int keypoints) {
  return {{"keypoints", keypoints}};
}

Shape motion_shape(const SearchCounts& counts) {
  return {{"matches", counts.matches},
          {"hypotheses", counts.hypotheses},
          {"inliers", counts.inliers},
          {"iterations", counts.iterations}};
}

}  // namespace partita::frontend
