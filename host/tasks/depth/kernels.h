// The depth task's kernels and host steps, for whoever runs, checks, packages or lists them.
#ifndef PARTITA_HOST_TASKS_DEPTH_KERNELS_H
#define PARTITA_HOST_TASKS_DEPTH_KERNELS_H

#include <vector>

#include "host/runtime/kernel_spec.h"

namespace partita::depth {

/// All kernels of the task; Session wants them.
std::vector<const runtime::KernelSpec*> kernel_specs();
std::vector<const runtime::HostSpec*> host_specs();

/// 3x3 Sobel of a picture, both directions. Shape: width, height.
const runtime::KernelSpec& sobel_spec();
/// 16-byte descriptors from the gradients. Shape: width, height.
const runtime::KernelSpec& descriptor_spec();
/// Disparities of the support grid. Shape: width, height, max_disparity, step, distinct.
const runtime::KernelSpec& support_match_spec();
/// Drops support points that their neighbours contradict. Shape: columns, rows, window.
const runtime::KernelSpec& support_plausible_spec();
/// Drops points between equal ones, per grid line. Shape: columns, rows, vertical, reach.
const runtime::KernelSpec& support_redundant_spec();
/// Lists the grid's points by row and column. Shape: columns, rows, points.
const runtime::KernelSpec& support_list_spec();
/// Marks the disparities seen in each cell. Shape: width, height, cell, step, max_disparity, right.
const runtime::KernelSpec& grid_seen_spec();
/// Lists those of each cell and its neighbours. Shape: width, height, cell, max_disparity, listed.
const runtime::KernelSpec& grid_prior_spec();
/// Expected disparity of each pixel from its triangle. Shape: width, height, triangles, spans,
/// covered.
const runtime::KernelSpec& plane_prior_spec();
/// Maximum a-posteriori disparities of one view. Shape: width, height, cell, max_disparity, radius,
/// right, entries, planes.
const runtime::KernelSpec& dense_match_spec();
/// Left-right check. Shape: width, height.
const runtime::KernelSpec& consistency_spec();
/// Segments of similar disparities in bands of rows, and across them. Shape: width, height.
const runtime::KernelSpec& segments_spec();
const runtime::KernelSpec& join_segments_spec();
/// Removes small segments. Shape: width, height.
const runtime::KernelSpec& remove_speckles_spec();
/// Fills gaps in rows or columns. Shape: width, height, vertical, gap, extend, filled.
const runtime::KernelSpec& fill_gaps_spec();
/// Filters along rows or columns. Shape: width, height, vertical.
const runtime::KernelSpec& adaptive_mean_spec();
const runtime::KernelSpec& median_spec();

/// Delaunay triangulation and planes of one view. Shape: points, triangles.
const runtime::HostSpec& triangulation_spec();

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_KERNELS_H
