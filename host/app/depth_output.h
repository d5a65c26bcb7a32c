// DepthOutput: writes disparity maps to disk and holds them against the truth, on a thread of its
// own so that the pictures' compression does not count as the scene's time.
#ifndef PARTITA_HOST_APP_DEPTH_OUTPUT_H
#define PARTITA_HOST_APP_DEPTH_OUTPUT_H

#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/tasks/depth/depth.h"
#include "host/tasks/depth/evaluation.h"
#include "host/tasks/sensing/frame.h"

namespace partita::app {

/// Over all frames so far.
struct DepthAccuracy {
  std::size_t frames = 0;
  double density = 0;  ///< mean share of pixels with a disparity, 0..1
  std::size_t frames_without_support = 0;
  depth::Evaluation evaluation;  ///< where truth is known
};

class DepthOutput {
 public:
  /// `folder`: where NNNNNN.png go; it exists.
  explicit DepthOutput(std::string folder);
  ~DepthOutput();
  DepthOutput(const DepthOutput&) = delete;
  DepthOutput& operator=(const DepthOutput&) = delete;

  /// Hands a map over; waits if the disk is many frames behind. Throws what an earlier write threw.
  void add(std::shared_ptr<const sensing::Frame> frame, depth::DisparityMap map);
  /// Waits until all is written; rethrows what went wrong.
  DepthAccuracy finish();

  /// The first frame's, for the overview picture; after finish().
  const std::optional<depth::DisparityMap>& first_map() const { return first_map_; }
  const std::shared_ptr<const sensing::Frame>& first_frame() const { return first_frame_; }

 private:
  struct Item {
    std::shared_ptr<const sensing::Frame> frame;
    depth::DisparityMap map;
  };
  void work();
  void account(const Item& item, const sensing::FloatImage& disparity);

  std::string folder_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> queue_;
  bool closed_ = false;
  std::exception_ptr error_;
  DepthAccuracy accuracy_;
  double density_sum_ = 0;
  std::optional<depth::DisparityMap> first_map_;
  std::shared_ptr<const sensing::Frame> first_frame_;
  std::thread thread_;
};

/// The map as floating-point pixels, 0 where there is none.
sensing::FloatImage to_pixels(const depth::DisparityMap& map);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_DEPTH_OUTPUT_H
