// The shapes of the depth task's launches: what it launches with, and what its program states.
#ifndef PARTITA_HOST_TASKS_DEPTH_SHAPES_H
#define PARTITA_HOST_TASKS_DEPTH_SHAPES_H

#include "host/runtime/shape.h"
#include "host/tasks/depth/counts.h"
#include "host/tasks/depth/depth.h"
#include "host/tasks/depth/geometry.h"

namespace partita::depth {

inline runtime::Shape picture_shape(Size size) {
  return {{"width", size.width}, {"height", size.height}};
}

/// How many points can be matched distinctly is not known before: half of them, which is typical.
inline runtime::Shape support_match_shape(Size size, const DepthParameters& p) {
  return picture_shape(size)
      .with("max_disparity", p.max_disparity)
      .with("step", p.candidate_step)
      .with("distinct", static_cast<std::int64_t>(area(grid_size(size, p.candidate_step))) / 2);
}

inline runtime::Shape grid_lines_shape(Size grid) {
  return {{"columns", grid.width}, {"rows", grid.height}};
}

inline runtime::Shape plausible_shape(Size grid, const DepthParameters& p) {
  return grid_lines_shape(grid).with("window", p.incon_window);
}

inline runtime::Shape redundant_shape(Size grid, const DepthParameters& p, int vertical) {
  return grid_lines_shape(grid).with("vertical", vertical).with("reach", p.redun_max_distance);
}

/// How many points there are is not known when it is launched: one in eight, which is typical.
inline runtime::Shape support_list_shape(Size grid) {
  return grid_lines_shape(grid).with("points", static_cast<std::int64_t>(area(grid)) / 8);
}

inline runtime::Shape grid_seen_shape(Size size, const DepthParameters& p, bool right) {
  return picture_shape(size)
      .with("cell", p.grid_size)
      .with("step", p.candidate_step)
      .with("max_disparity", p.max_disparity)
      .with("right", right);
}

/// Likewise twelve disparities a cell.
inline runtime::Shape grid_prior_shape(Size size, const DepthParameters& p) {
  return picture_shape(size)
      .with("cell", p.grid_size)
      .with("max_disparity", p.max_disparity)
      .with("listed", 12 * static_cast<std::int64_t>(area(cell_size(size, p.grid_size))));
}

inline runtime::Shape triangulation_shape(const FrameCounts& frame, const ViewCounts& view) {
  return {{"points", frame.support_points}, {"triangles", view.triangles}};
}

inline runtime::Shape plane_prior_shape(Size size, const ViewCounts& view) {
  return picture_shape(size)
      .with("triangles", view.triangles)
      .with("spans", view.spans)
      .with("covered", view.covered)
      .with("overlaps", view.overlaps);
}

inline runtime::Shape dense_match_shape(Size size, const DepthParameters& p, const ViewCounts& view,
                                        bool right) {
  return picture_shape(size)
      .with("cell", p.grid_size)
      .with("max_disparity", p.max_disparity)
      .with("radius", plane_radius(p))
      .with("right", right)
      .with("entries", view.entries)
      .with("planes", view.covered);
}

/// How much there is to fill is not known before: one pixel in 25, which is typical.
inline runtime::Shape fill_gaps_shape(Size size, const DepthParameters& p, int vertical) {
  return picture_shape(size)
      .with("vertical", vertical)
      .with("gap", p.ipol_gap_width)
      .with("extend", p.add_corners)
      .with("filled", static_cast<std::int64_t>(area(size)) / 25);
}

inline runtime::Shape filter_shape(Size size, int vertical) {
  return picture_shape(size).with("vertical", vertical);
}

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_SHAPES_H
