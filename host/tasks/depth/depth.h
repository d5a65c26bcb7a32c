// Depth from a rectified stereo pair: ELAS (Geiger, Roser, Urtasun, "Efficient Large-Scale Stereo
// Matching", ACCV 2010). Sparse support points that match safely are triangulated; the triangles'
// planes say where to look for every other pixel's disparity, and a maximum a-posteriori choice
// among few candidates decides it. Symbols below are the paper's.
//
// Everything but the triangulation runs on the session's device, in integers: the disparities are
// the same on every device and in every variant.
#ifndef PARTITA_HOST_TASKS_DEPTH_DEPTH_H
#define PARTITA_HOST_TASKS_DEPTH_DEPTH_H

#include <cstdint>
#include <memory>
#include <vector>

#include "host/runtime/session.h"
#include "host/tasks/depth/counts.h"
#include "host/tasks/depth/parameters.h"
#include "host/tasks/sensing/frame.h"

namespace partita::depth {

/// Disparities of the left image in unsigned fixed point with 8 fractional bits, as KITTI's 16-bit
/// PNGs store them: value / 256 is the disparity in pixels, 0 means "none". A disparity of zero (a
/// point at infinity) is stored as 1, which is 1/256 px, and so stays apart from "none".
struct DisparityMap {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> values;  ///< row-major, width * height

  /// Too few support points (fewer than three, or all on one line): nothing could be triangulated
  /// and the map is empty. Black, blank or foreign pictures end here.
  bool too_few_support_points = false;
  FrameCounts counts;  ///< what its cost followed from

  std::uint16_t at(int x, int y) const {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  bool valid(int x, int y) const { return at(x, y) != 0; }
  float pixels(int x, int y) const { return static_cast<float>(at(x, y)) / 256.0f; }
  /// Share of pixels that have a disparity, 0..1.
  double density() const;
};

/// One stereo camera's depth on one device. All buffers are allocated by the constructor.
class Depth {
 public:
  /// Throws Error for a parameter out of range, a max_disparity beyond the width, or a picture
  /// smaller than 32 x 16 or larger than 4096 x 4096 (an FPGA takes widths up to 1600).
  Depth(const runtime::Session& session, int width, int height, const DepthParameters& parameters);
  ~Depth();
  Depth(Depth&&) noexcept;
  Depth& operator=(Depth&&) noexcept;

  /// The left image's disparities; returns when they are in host memory. Throws Error if either
  /// picture's size is not that of the constructor.
  DisparityMap process(const sensing::GrayImage& left, const sensing::GrayImage& right,
                       std::int64_t frame);

  /// Launches every kernel once at its exact geometry, so that no frame pays for compilation.
  void warm_up();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_DEPTH_H
