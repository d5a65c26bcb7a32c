// The front-end's kernels and host steps, for sessions, `verify`, `bench`, the packager and tests.
#ifndef PARTITA_HOST_TASKS_FRONTEND_KERNELS_H
#define PARTITA_HOST_TASKS_FRONTEND_KERNELS_H

#include <vector>

#include "host/runtime/kernel_spec.h"

namespace partita::frontend {

/// Shape entries: width and height of the image that the launch reads, and what each says.
const runtime::KernelSpec& pyramid_down_spec();   ///< width height (of the source)
const runtime::KernelSpec& fast_score_spec();     ///< width height
const runtime::KernelSpec& gaussian_blur_spec();  ///< width height
const runtime::KernelSpec& select_cells_spec();   ///< width height cell
const runtime::KernelSpec& compact_spec();        ///< cells keypoints
const runtime::KernelSpec& describe_spec();       ///< width height keypoints
/// width height cell0 cell1 queries trains, and what the search meets: searched (queries with a
/// prediction), rows (runs of cells), visited (features in them), candidates (those inside the
/// windows): exact in a check, in a run expected from the features' density, as nobody has counted
/// them beforehand
const runtime::KernelSpec& match_window_spec();
const runtime::KernelSpec& invert_matches_spec();  ///< queries trains
/// width height queries matches range_x range_y
const runtime::KernelSpec& refine_sad_spec();

std::vector<const runtime::KernelSpec*> kernel_specs();

/// Relative pose from matches: shape has matches, hypotheses, inliers, iterations.
const runtime::HostSpec& motion_spec();
/// Prediction of where the features will be: shape has keypoints.
const runtime::HostSpec& predict_spec();

std::vector<const runtime::HostSpec*> host_specs();

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_KERNELS_H
