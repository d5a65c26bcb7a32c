#include "host/tasks/depth/depth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <future>
#include <span>
#include <string>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/runtime/host_step.h"
#include "host/runtime/kernel.h"
#include "host/tasks/depth/geometry.h"
#include "host/tasks/depth/kernels.h"
#include "host/tasks/depth/planes.h"
#include "host/tasks/depth/shapes.h"
#include "host/tasks/depth/synthetic.h"

namespace partita::depth {
namespace {

using runtime::Kernel;
using runtime::Session;
using runtime::Shape;

void check_size(const Session& session, Size size, const DepthParameters& p) {
  if (size.width < kSmallestWidth || size.height < kSmallestHeight) {
    throw Error(fmt::format("depth: pictures of {} x {}, expected at least {} x {}", size.width,
                            size.height, kSmallestWidth, kSmallestHeight));
  }
  if (size.width > kLargestSide || size.height > kLargestSide) {
    throw Error(fmt::format("depth: pictures of {} x {}, expected at most {} x {}", size.width,
                            size.height, kLargestSide, kLargestSide));
  }
  const bool fpga = session.charged() == runtime::Variant::fpga;
  if (fpga && size.width > kFpgaWidth) {
    throw Error(fmt::format("depth: pictures {} wide, the FPGA's row buffers hold {}", size.width,
                            kFpgaWidth));
  }
  if (p.max_disparity >= size.width) {
    throw Error(fmt::format("depth: max_disparity is {}, expected less than the width, {}",
                            p.max_disparity, size.width));
  }
}

/// What Session has no call for, with its kind of error.
template <typename Call>
void on_queue(const Session& session, const char* what, const Call& call) {
  try {
    call(session.queue());
  } catch (const cl::Error& error) {
    throw DeviceError(fmt::format("{}: {} failed ({})", session.device().name, what,
                                  runtime::error_name(error.err())));
  }
}

template <typename T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span<const T>(values));
}

/// What one view needs on the device and, while it is being copied, on the host.
struct View {
  cl::Buffer picture;
  cl::Buffer descriptors;
  cl::Buffer seen;
  cl::Buffer counts;
  cl::Buffer lists;
  cl::Buffer corners;
  cl::Buffer planes;
  cl::Buffer map;
  cl::Buffer disparities;
  Mesh mesh;
  ViewCounts totals;
  std::vector<std::uint16_t> host_counts;
};

}  // namespace

double DisparityMap::density() const {
  if (values.empty()) return 0;
  const auto none = std::count(values.begin(), values.end(), std::uint16_t{0});
  return 1.0 - static_cast<double>(none) / static_cast<double>(values.size());
}

struct Depth::Impl {
  Impl(const Session& s, Size picture, const DepthParameters& p);

  DisparityMap process(const sensing::GrayImage& left, const sensing::GrayImage& right,
                       std::int64_t frame);
  void describe(View& view, const sensing::GrayImage& image);
  void find_support();
  void list_support();
  void seen_disparities(View& view, bool is_right);
  void triangulate();
  bool send_mesh(View& view);
  FrameCounts counts() const;
  void match(View& view, const View& other, bool is_right);
  void post_process();
  void filter(Kernel& kernel);

  const Session* session;
  Size size;
  Size grid;
  Size cells;
  DepthParameters parameters;
  Kernel sobel;
  Kernel descriptor;
  Kernel support_match;
  Kernel support_plausible;
  Kernel support_redundant;
  Kernel support_list;
  Kernel grid_seen;
  Kernel grid_prior;
  Kernel plane_prior;
  Kernel dense_match;
  Kernel consistency;
  Kernel segments;
  Kernel join_segments;
  Kernel remove_speckles;
  Kernel fill_gaps;
  Kernel adaptive_mean;
  Kernel median;
  cl::Buffer du;
  cl::Buffer dv;
  cl::Buffer grid_matched;
  cl::Buffer grid_plausible;
  cl::Buffer grid_thinned;
  cl::Buffer list;
  cl::Buffer count;
  cl::Buffer prior;
  cl::Buffer labels;
  cl::Buffer sizes;
  cl::Buffer out;
  cl::Buffer filtered;
  View left_view;
  View right_view;
  std::vector<SupportPoint> support;
};

Depth::Impl::Impl(const Session& s, Size picture, const DepthParameters& p)
    : session(&s),
      size(picture),
      grid(grid_size(picture, p.candidate_step)),
      cells(cell_size(picture, p.grid_size)),
      parameters(p),
      sobel(s, sobel_spec()),
      descriptor(s, descriptor_spec()),
      support_match(s, support_match_spec()),
      support_plausible(s, support_plausible_spec()),
      support_redundant(s, support_redundant_spec()),
      support_list(s, support_list_spec()),
      grid_seen(s, grid_seen_spec()),
      grid_prior(s, grid_prior_spec()),
      plane_prior(s, plane_prior_spec()),
      dense_match(s, dense_match_spec()),
      consistency(s, consistency_spec()),
      segments(s, segments_spec()),
      join_segments(s, join_segments_spec()),
      remove_speckles(s, remove_speckles_spec()),
      fill_gaps(s, fill_gaps_spec()),
      adaptive_mean(s, adaptive_mean_spec()),
      median(s, median_spec()) {
  const std::size_t pixels = area(size);
  const std::size_t points = area(grid);
  du = s.make_buffer(pixels);
  dv = s.make_buffer(pixels);
  grid_matched = s.make_buffer(points * sizeof(std::int16_t));
  grid_plausible = s.make_buffer(points * sizeof(std::int16_t));
  grid_thinned = s.make_buffer(points * sizeof(std::int16_t));
  list = s.make_buffer(points * sizeof(SupportPoint));
  count = s.make_buffer(sizeof(std::uint32_t));
  const auto energies = prior_energies(p.beta, p.gamma, p.sigma, plane_radius(p));
  prior = s.make_buffer(energies.size() * sizeof(std::uint16_t), CL_MEM_READ_ONLY);
  labels = s.make_buffer(pixels * sizeof(std::int32_t));
  sizes = s.make_buffer(pixels * sizeof(std::int32_t));
  out = s.make_buffer(pixels * sizeof(std::uint16_t));
  filtered = s.make_buffer(pixels * sizeof(std::uint16_t));
  for (View* view : {&left_view, &right_view}) {
    view->picture = s.make_buffer(pixels, CL_MEM_READ_ONLY);
    view->descriptors = s.make_buffer(pixels * kDescriptorBytes);
    view->seen = s.make_buffer(area(cells) * kSeenWords * sizeof(std::uint32_t));
    view->counts = s.make_buffer(area(cells) * sizeof(std::uint16_t));
    view->lists = s.make_buffer(area(cells) * static_cast<std::size_t>(p.max_disparity + 1));
    // A triangulation of n points has fewer than 2 n triangles.
    const std::size_t triangles = 2 * (points + kCornerPoints);
    view->corners = s.make_buffer(triangles * kCornerEntries * sizeof(std::int16_t));
    view->planes = s.make_buffer(triangles * kPlaneEntries * sizeof(std::int32_t));
    view->map = s.make_buffer(pixels * sizeof(std::int16_t));
    view->disparities = s.make_buffer(pixels * sizeof(std::uint16_t));
    view->host_counts.resize(area(cells));
  }
  s.write(prior, bytes_of(energies));
  s.finish();
}

void Depth::Impl::describe(View& view, const sensing::GrayImage& image) {
  const Shape shape = picture_shape(size);
  session->write(view.picture, bytes_of(image.pixels));
  sobel.launch(shape, view.picture, du, dv, size.width, size.height);
  descriptor.launch(shape, du, dv, view.descriptors, size.width, size.height);
}

void Depth::Impl::find_support() {
  const DepthParameters& p = parameters;
  const int percent = static_cast<int>(std::lround(100 * p.support_threshold));
  support_match.launch(support_match_shape(size, p), left_view.descriptors, right_view.descriptors,
                       grid_matched, size.width, size.height, p.candidate_step, p.max_disparity,
                       p.support_texture, percent, p.lr_threshold);
  support_plausible.launch(plausible_shape(grid, p), grid_matched, grid_plausible, grid.width,
                           grid.height, p.incon_window, p.incon_threshold, p.incon_min_support);
  on_queue(*session, "copying the support grid", [&](const cl::CommandQueue& queue) {
    queue.enqueueCopyBuffer(grid_plausible, grid_thinned, 0, 0, area(grid) * sizeof(std::int16_t));
  });
  for (const int vertical : {1, 0}) {
    support_redundant.launch(redundant_shape(grid, p, vertical), grid_thinned, grid.width,
                             grid.height, vertical, p.redun_max_distance, p.redun_threshold);
  }
}

void Depth::Impl::list_support() {
  support_list.launch(support_list_shape(grid), grid_thinned, list, count, grid.width, grid.height,
                      parameters.candidate_step);
  std::uint32_t points = 0;
  session->read(count, std::as_writable_bytes(std::span(&points, 1)));
  support.resize(points);
  if (points > 0) session->read(list, std::as_writable_bytes(std::span(support)));
}

void Depth::Impl::seen_disparities(View& view, bool is_right) {
  const DepthParameters& p = parameters;
  grid_seen.launch(grid_seen_shape(size, p, is_right), grid_plausible, view.seen, cells.width,
                   cells.height, p.grid_size, grid.width, grid.height, p.candidate_step,
                   p.max_disparity, static_cast<int>(is_right));
  grid_prior.launch(grid_prior_shape(size, p), view.seen, view.counts, view.lists, cells.width,
                    cells.height, p.max_disparity);
}

/// Makes both views' meshes, side by side.
void Depth::Impl::triangulate() {
  const auto points = parameters.add_corners ? add_corners(support, size) : support;
  auto right = std::async(std::launch::async, [&] { return make_mesh(points, true); });
  left_view.mesh = make_mesh(points, false);
  right_view.mesh = right.get();
}

/// Sends the view's mesh up; false if there is none.
bool Depth::Impl::send_mesh(View& view) {
  view.totals = {.triangles = view.mesh.triangles,
                 .spans = view.mesh.spans,
                 .covered = view.mesh.covered,
                 .overlaps = view.mesh.overlaps};
  declare_host_step(*session, triangulation_spec(), triangulation_shape(counts(), view.totals));
  if (view.mesh.triangles == 0) return false;
  session->write(view.corners, bytes_of(view.mesh.corners));
  session->write(view.planes, bytes_of(view.mesh.planes));
  return true;
}

FrameCounts Depth::Impl::counts() const {
  return {static_cast<std::int64_t>(support.size()), {left_view.totals, right_view.totals}};
}

void Depth::Impl::match(View& view, const View& other, bool is_right) {
  plane_prior.launch(plane_prior_shape(size, view.totals), view.corners, view.planes, view.map,
                     size.width, size.height, view.mesh.triangles);
  // The lists' lengths say what the matching costs; they have been ready since before the meshes.
  std::int64_t& entries = view.totals.entries;
  const int side = parameters.grid_size;
  for (int cy = 0; cy < cells.height; ++cy) {
    for (int cx = 0; cx < cells.width; ++cx) {
      const std::int64_t n = view.host_counts[static_cast<std::size_t>(cy * cells.width + cx)];
      entries +=
          n * std::min(side, size.width - cx * side) * std::min(side, size.height - cy * side);
    }
  }
  const int last = parameters.max_disparity;
  dense_match.launch(dense_match_shape(size, parameters, view.totals, is_right), view.descriptors,
                     other.descriptors, view.map, view.counts, view.lists, prior, view.disparities,
                     size.width, size.height, side, last, plane_radius(parameters),
                     static_cast<int>(is_right), parameters.match_texture);
}

/// Speckles, gaps, filters: in `out`.
void Depth::Impl::post_process() {
  const DepthParameters& p = parameters;
  const Shape shape = picture_shape(size);
  if (p.speckle_size > 1) {
    const int similarity = p.speckle_similarity * 256;
    segments.launch(shape, out, labels, sizes, size.width, size.height, similarity);
    join_segments.launch(shape, out, labels, sizes, size.width, size.height, similarity);
    remove_speckles.launch(shape, out, labels, sizes, size.width, size.height, p.speckle_size);
  }
  if (p.ipol_gap_width > 0) {
    for (const int vertical : {0, 1}) {
      fill_gaps.launch(fill_gaps_shape(size, p, vertical), out, size.width, size.height, vertical,
                       p.ipol_gap_width, static_cast<int>(p.add_corners));
    }
  }
  if (p.filter_adaptive_mean) filter(adaptive_mean);
  if (p.filter_median) filter(median);
}

/// Along the rows, then along the columns.
void Depth::Impl::filter(Kernel& kernel) {
  kernel.launch(filter_shape(size, 0), out, filtered, size.width, size.height, 0);
  kernel.launch(filter_shape(size, 1), filtered, out, size.width, size.height, 1);
}

DisparityMap Depth::Impl::process(const sensing::GrayImage& left, const sensing::GrayImage& right,
                                  std::int64_t frame) {
  for (const sensing::GrayImage* image : {&left, &right}) {
    if (image->width == size.width && image->height == size.height) continue;
    throw Error(fmt::format("depth: frame {}: {} picture is {} x {}, expected {} x {}", frame,
                            image == &left ? "left" : "right", image->width, image->height,
                            size.width, size.height));
  }
  session->extension().set_label("depth", frame);
  describe(left_view, left);
  describe(right_view, right);
  find_support();
  list_support();

  DisparityMap map{size.width, size.height, std::vector<std::uint16_t>(area(size))};
  // The device finds out which disparities occur where while the host triangulates.
  for (View* view : {&left_view, &right_view}) {
    seen_disparities(*view, view == &right_view);
    on_queue(*session, "reading a buffer", [&](const cl::CommandQueue& queue) {
      queue.enqueueReadBuffer(view->counts, CL_FALSE, 0,
                              view->host_counts.size() * sizeof(std::uint16_t),
                              view->host_counts.data());
      queue.flush();
    });
  }
  left_view.totals = right_view.totals = {};
  triangulate();
  const bool meshed = send_mesh(left_view) && send_mesh(right_view);
  session->finish();
  if (!meshed) {
    map.too_few_support_points = true;
    map.counts = counts();
    return map;
  }
  match(left_view, right_view, false);
  match(right_view, left_view, true);
  map.counts = counts();
  consistency.launch(picture_shape(size), left_view.disparities, right_view.disparities, out,
                     size.width, size.height, parameters.lr_threshold);
  post_process();
  session->read(out, std::as_writable_bytes(std::span(map.values)));
  return map;
}

Depth::Depth(const Session& session, int width, int height, const DepthParameters& parameters) {
  check_parameters(parameters);
  check_size(session, {width, height}, parameters);
  impl_ = std::make_unique<Impl>(session, Size{width, height}, parameters);
}

Depth::~Depth() = default;
Depth::Depth(Depth&&) noexcept = default;
Depth& Depth::operator=(Depth&&) noexcept = default;

DisparityMap Depth::process(const sensing::GrayImage& left, const sensing::GrayImage& right,
                            std::int64_t frame) {
  return impl_->process(left, right, frame);
}

void Depth::warm_up() {
  const double disparity = std::min(8, impl_->parameters.max_disparity / 2);
  const SyntheticPair pair = synthetic_pair(impl_->size, {0, 0, disparity}, 1);
  process(pair.left, pair.right, 0);
}

}  // namespace partita::depth
