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
#include "host/tasks/sensing/frame.h"

namespace partita::depth {

/// Named as in the paper and in its authors' library. The defaults are the "robotics" setting.
struct DepthParameters {
  int max_disparity = 127;  ///< largest disparity searched, px; 15..255, below the width
  int candidate_step = 5;   ///< support points are sought on a grid of this pitch, px; 5..32
  double support_threshold = 0.85;  ///< τ: best cost / second best at most this; 0 < τ <= 1
  int support_texture = 10;         ///< least Σ|descriptor - 128| of a support point; 0..2048
  int lr_threshold = 2;             ///< largest left-right difference accepted, px; 0..255
  int incon_window = 5;             ///< neighbourhood of the plausibility test, grid steps; 1..16
  int incon_threshold = 5;          ///< largest difference to a supporting neighbour, px; 0..255
  int incon_min_support = 5;        ///< neighbours (itself included) that a point needs; 1..1000
  int redun_max_distance = 5;       ///< reach of the redundancy test, grid steps; 1..16
  int redun_threshold = 1;  ///< a point this close to both neighbours is redundant, px; 0..255
  double beta = 0.02;       ///< β: weight of the descriptors' L1 distance; 0.001..1
  double gamma = 3;         ///< γ: the prior's uniform share; 0.01..100
  double sigma = 1;         ///< σ of the plane prior, px; 0.1..10. Disparities within 2 px of
                            ///< the plane are tried whatever σ is
  int match_texture = 1;    ///< least Σ|descriptor - 128| of a pixel to be matched; 0..2048
};

/// The defaults, with no more disparities than pictures of that width can have.
DepthParameters default_parameters(int width);

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
