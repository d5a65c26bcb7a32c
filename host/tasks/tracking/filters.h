// Kernelized correlation filters (KCF: Henriques, Caseiro, Martins, Batista, "High-Speed Tracking
// with Kernelized Correlation Filters", TPAMI 2015) for many targets at once, on one device: each
// launch takes all targets, and all scales at which they are looked for. A target is seen through a
// square window around its box, resampled to a canonical template, so that small ones work as large
// ones do; features are 31 channels of HOG.
//
// Kernels give the same bytes on every device and in every variant, and so do the boxes.
#ifndef PARTITA_HOST_TASKS_TRACKING_FILTERS_H
#define PARTITA_HOST_TASKS_TRACKING_FILTERS_H

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host/runtime/session.h"
#include "host/tasks/sensing/frame.h"
#include "host/tasks/tracking/box.h"

namespace partita::tracking {

struct FilterParameters {
  int template_side = 64;        ///< px of the canonical template: 64 or 128
  double padding = 1.7;          ///< the window's side over the root of the box's area; 1.1..5
  double sigma = 0.6;            ///< of the Gaussian kernel; 0.05..5
  double label_deviation = 0.1;  ///< of the response trained for, over the box's side; 0.01..1
  double regularisation = 1e-4;  ///< lambda; 1e-6..1
  double rate = 0.012;           ///< share of the newest frame in model and filter; 0..1
  int scales = 3;                ///< sizes tried, odd: 1, 3, 5 or 7
  double scale_step = 1.05;      ///< from one size to the next; 1.005..1.5
  double scale_penalty = 0.95;   ///< another size has to be this much better: 0.5..1
};

/// A target: where it is expected, and the slot of its filter.
struct Target {
  std::int32_t slot = 0;
  Box box;
  bool fresh = false;  ///< train: replaces what is in the slot
};

struct Located {
  Box box;
  double response = 0;  ///< the filter's largest response: 1 is what it was trained for
};

class Filters {
 public:
  /// For pictures of that size and at most `capacity` targets (slots 0 .. capacity - 1). Throws
  /// Error for a parameter out of range, or pictures smaller than 16 x 16 or larger than 8192 x
  /// 8192.
  Filters(const runtime::Session& session, int width, int height,
          const FilterParameters& parameters, int capacity);
  ~Filters();
  Filters(Filters&&) noexcept;
  Filters& operator=(Filters&&) noexcept;

  /// The picture that the following calls look at. Throws Error if its size is not that of the
  /// constructor. The picture has to stay alive until the next locate() or finish().
  void look_at(const sensing::GrayImage& image);
  /// Looks for trained targets around their boxes; returns when the answers are in host memory.
  std::vector<Located> locate(std::span<const Target> targets);
  /// Trains filters on the targets as their boxes say; does not wait.
  void train(std::span<const Target> targets);
  void finish();

  /// Bilinear samples that the patches of the last locate() or train() took.
  std::int64_t samples() const;

  /// Launches every kernel once at its exact geometry, so that no frame pays for compilation.
  void warm_up();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_FILTERS_H
