// The shapes of the front-end's launches: what the task launches with, and what its program states.
#ifndef PARTITA_HOST_TASKS_FRONTEND_SHAPES_H
#define PARTITA_HOST_TASKS_FRONTEND_SHAPES_H

#include "host/runtime/shape.h"
#include "host/tasks/frontend/frontend.h"
#include "host/tasks/frontend/layout.h"

namespace partita::frontend {

/// How far refine_sad looks around a match, pixels of the level, either side.
struct SadRange {
  int x = 0;
  int y = 0;
};
inline constexpr SadRange kStereoRange{5, 0};
inline constexpr SadRange kTemporalRange{2, 2};

/// Where the right image's feature can be from the left one's (`forward`), or the other way round.
Window stereo_window(const FrontendParameters& parameters, bool forward);
Window temporal_window(const FrontendParameters& parameters, bool wide);

runtime::Shape image_shape(Size size);
runtime::Shape select_shape(Size size, const Grid& grid);
/// How many keypoints there are is not known when it is launched: half of what the grids hold.
runtime::Shape compact_shape(const Grids& grids);
runtime::Shape describe_shape(const Grids& grids, int keypoints);
/// What the search meets is expected from the features' density, as if they lay evenly.
runtime::Shape match_shape(const Grids& grids, int queries, int trains, const Window& window,
                           int searched);
runtime::Shape invert_shape(int queries, int trains);
/// Likewise the number of matches: half of the fewer features.
runtime::Shape refine_shape(const Grids& grids, int queries, int trains, const SadRange& range);
runtime::Shape predict_shape(int keypoints);
runtime::Shape motion_shape(const SearchCounts& counts);

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_SHAPES_H
