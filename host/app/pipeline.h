// Pipeline: the two branches of perception, each on its device and driven by a host thread of its
// own, over a sequence of frames.
#ifndef PARTITA_HOST_APP_PIPELINE_H
#define PARTITA_HOST_APP_PIPELINE_H

#include <array>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "host/app/frame_feed.h"
#include "host/app/run_counts.h"
#include "host/runtime/session.h"
#include "host/tasks/depth/depth.h"
#include "host/tasks/frontend/frontend.h"
#include "partition/placement.h"

namespace partita::app {

using partition::Branch;

struct PipelineOptions {
  std::string machine;
  partition::Placement placement;
  runtime::Execute execute = runtime::Execute::fast;
  bool drop_late = false;
  std::string container;  ///< for a device that takes no source; empty: packaged for the machine
};

/// A frame as one branch processed it; times are wall_now()'s.
struct WallFrame {
  std::size_t frame = 0;
  std::uint64_t start = 0;
  std::uint64_t end = 0;
};

struct BranchRun {
  std::vector<WallFrame> frames;
  std::vector<std::size_t> dropped;
};

/// What the scene had to do for a frame.
struct SceneCounts {
  std::int64_t frame = 0;
  depth::FrameCounts counts;
};

struct PipelineRun {
  std::array<BranchRun, partition::kBranches.size()> branches;
  /// One per processed frame; features only of the first, which is drawn.
  std::vector<frontend::FrontendResult> localization;
  std::vector<SceneCounts> scene;  ///< one per processed frame
  bool stopped = false;            ///< by a signal
  std::exception_ptr error;        ///< what ended the run early; what was finished before is valid

  /// Of `localization`: those with a pose of their own, the first included.
  std::size_t tracked_frames() const;
  /// What the first `frames` frames had to do, those that both branches did.
  std::vector<FrameWork> work(std::size_t frames) const;
  const BranchRun& of(Branch branch) const { return branches[static_cast<std::size_t>(branch)]; }
};

/// Receives each frame's disparities, on the scene's thread.
using DepthSink = std::function<void(std::shared_ptr<const sensing::Frame>, depth::DisparityMap)>;

class Pipeline {
 public:
  /// Opens the devices and loads all kernels. The machine's environment is already set. Throws
  /// Error for a placement on a device that the machine does not have, DeviceError for OpenCL's
  /// refusals.
  Pipeline(const PipelineOptions& options, const sensing::StereoCalibration& calibration);

  /// Runs every kernel once, so that no frame pays for compilation, and saves the binaries.
  void warm_up();

  /// Processes the feed's frames; arrivals[k] is the virtual time at which frame k is there. Each
  /// branch does every frame (unless drop_late), and all branches the same frames: after a signal
  /// the slower one catches up. Never throws: see PipelineRun::error.
  PipelineRun run(FrameFeed& feed, const std::vector<std::uint64_t>& arrivals,
                  const DepthSink& sink, const std::function<void(std::size_t)>& progress);

  const runtime::Session& session(Branch branch) const {
    return *sessions_[static_cast<std::size_t>(branch)];
  }
  /// Whether there is a predicted clock.
  bool predicted() const { return session(Branch::localization).extension().present(); }

 private:
  std::array<std::unique_ptr<runtime::Session>, partition::kBranches.size()> sessions_;
  std::unique_ptr<frontend::Frontend> frontend_;
  std::unique_ptr<depth::Depth> depth_;
  PipelineOptions options_;
};

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_PIPELINE_H
