#include "host/app/pipeline.h"

#include <algorithm>
#include <optional>
#include <thread>

#include "host/app/packager.h"
#include "host/app/stop.h"
#include "host/app/turns.h"
#include "host/app/wall_clock.h"
#include "host/tasks/depth/kernels.h"
#include "host/tasks/frontend/kernels.h"

namespace partita::app {
namespace {

std::unique_ptr<runtime::Session> open_session(const PipelineOptions& options,
                                               const runtime::Device& device, Branch branch) {
  runtime::SessionOptions session;
  session.execute = options.execute;
  if (!device.accepts_source) {
    session.container = container_for(device, options.machine, options.execute, options.container);
  }
  return std::make_unique<runtime::Session>(
      device, branch == Branch::localization ? frontend::kernel_specs() : depth::kernel_specs(),
      session);
}

/// Which frames may still be started; shared by the branches.
class Progress {
 public:
  Progress(std::size_t frames, const std::function<void(std::size_t)>& report)
      : limit_(frames), report_(report) {}

  bool may_start(Branch branch, std::size_t frame) {
    const std::lock_guard lock(mutex_);
    if (stop_requested() && !stopped_) {
      stopped_ = true;
      limit_ = std::min(limit_, *std::max_element(started_.begin(), started_.end()));
    }
    if (frame >= limit_) return false;
    started_[static_cast<std::size_t>(branch)] = frame + 1;
    return true;
  }
  void finished(Branch branch, std::size_t frame) {
    const std::lock_guard lock(mutex_);
    finished_[static_cast<std::size_t>(branch)] = frame + 1;
    report_(*std::min_element(finished_.begin(), finished_.end()));
  }
  /// `branch` could not finish the frame that it started last. The others still do the frames
  /// before it, so that what is finished does not depend on who was ahead; of two errors, the one
  /// at the earlier frame is told.
  void fail(Branch branch, std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    const std::size_t started = started_[static_cast<std::size_t>(branch)];
    const std::size_t failed = started > 0 ? started - 1 : 0;
    if (error_ && failed >= limit_) return;
    error_ = std::move(error);
    limit_ = std::min(limit_, failed);
  }
  bool stopped() const { return stopped_; }
  std::exception_ptr error() const { return error_; }

 private:
  std::mutex mutex_;
  std::size_t limit_;
  std::array<std::size_t, partition::kBranches.size()> started_{}, finished_{};
  bool stopped_ = false;
  std::exception_ptr error_;
  const std::function<void(std::size_t)>& report_;
};

/// One branch's way through the frames, on a host thread of its own.
class BranchDriver {
 public:
  using Process = std::function<void(const std::shared_ptr<const sensing::Frame>&)>;

  BranchDriver(Branch branch, const runtime::Session& session, FrameFeed& feed,
               const std::vector<std::uint64_t>& arrivals, Turns* turns, Progress& progress,
               BranchRun& run)
      : branch_(branch),
        index_(static_cast<std::size_t>(branch)),
        session_(session),
        feed_(feed),
        arrivals_(arrivals),
        turns_(turns),
        progress_(progress),
        run_(run) {}

  void drive(const Process& process) {
    try {
      const runtime::Extension& clock = session_.extension();
      clock.bind_thread(std::string(to_string(branch_)).c_str(), static_cast<unsigned>(index_),
                        session_.device());
      for (std::size_t k = 0; k < feed_.size() && progress_.may_start(branch_, k); ++k) {
        if (!too_late(k)) step(process, feed_.get(index_, k), k);
        progress_.finished(branch_, k);
      }
    } catch (...) {
      progress_.fail(branch_, std::current_exception());
    }
    feed_.leave(index_);
    if (turns_ != nullptr) turns_->leave(index_);
  }

 private:
  /// With --drop-late: whether this frame's successor is already there when its turn comes.
  bool too_late(std::size_t k) {
    if (turns_ == nullptr) return false;
    const std::uint64_t now = session_.extension().host_clock();
    turns_->wait_turn(index_, std::max(now, arrivals_[k]));
    if (k + 1 >= arrivals_.size() || now <= arrivals_[k + 1]) return false;
    run_.dropped.push_back(k);
    return true;
  }

  void step(const Process& process, const std::shared_ptr<const sensing::Frame>& frame,
            std::size_t k) {
    const runtime::Extension& clock = session_.extension();
    WallFrame wall{k, wall_now(), 0};
    clock.wait_until(arrivals_[k]);
    clock.set_label("sensing", static_cast<std::int64_t>(k));
    clock.sensor_input("stereo", frame->left.pixels.size() + frame->right.pixels.size());
    process(frame);
    wall.end = wall_now();
    run_.frames.push_back(wall);
  }

  Branch branch_;
  std::size_t index_;
  const runtime::Session& session_;
  FrameFeed& feed_;
  const std::vector<std::uint64_t>& arrivals_;
  Turns* turns_;
  Progress& progress_;
  BranchRun& run_;
};

}  // namespace

std::size_t PipelineRun::tracked_frames() const {
  return static_cast<std::size_t>(
      std::count_if(localization.begin(), localization.end(),
                    [](const auto& frame) { return frame.tracked || frame.first; }));
}

std::vector<FrameWork> PipelineRun::work(std::size_t frames) const {
  std::vector<FrameWork> common;
  auto other = scene.begin();
  for (const frontend::FrontendResult& pose : localization) {
    while (other != scene.end() && other->frame < pose.frame) ++other;
    if (other == scene.end() || pose.frame >= static_cast<std::int64_t>(frames)) break;
    if (other->frame == pose.frame) common.push_back({pose.frame, pose.counts, other->counts});
  }
  return common;
}

Pipeline::Pipeline(const PipelineOptions& options, const sensing::StereoCalibration& calibration)
    : options_(options) {
  const std::vector<runtime::Device> devices = runtime::find_devices();
  // Both are looked up before either is opened: a wrong name is told at once.
  std::array<std::optional<runtime::Device>, partition::kBranches.size()> chosen;
  for (const Branch branch : partition::kBranches) {
    chosen[static_cast<std::size_t>(branch)] =
        runtime::select_device(devices, options.placement.of(branch));
  }
  for (const Branch branch : partition::kBranches) {
    const auto index = static_cast<std::size_t>(branch);
    sessions_[index] = open_session(options, *chosen[index], branch);
  }
  frontend_ = std::make_unique<frontend::Frontend>(session(Branch::localization), calibration);
  depth_ =
      std::make_unique<depth::Depth>(session(Branch::scene), calibration.width, calibration.height,
                                     depth::default_parameters(calibration.width));
}

void Pipeline::warm_up() {
  frontend_->warm_up();
  session(Branch::localization).save_binaries();
  depth_->warm_up();
  session(Branch::scene).save_binaries();
}

PipelineRun Pipeline::run(FrameFeed& feed, const std::vector<std::uint64_t>& arrivals,
                          const DepthSink& sink, const std::function<void(std::size_t)>& report) {
  PipelineRun result;
  Progress progress(feed.size(), report);
  Turns turns(partition::kBranches.size());
  const auto driver = [&](Branch branch) {
    return BranchDriver(branch, session(branch), feed, arrivals,
                        options_.drop_late ? &turns : nullptr, progress,
                        result.branches[static_cast<std::size_t>(branch)]);
  };
  std::thread localization([&] {
    driver(Branch::localization).drive([&](const std::shared_ptr<const sensing::Frame>& frame) {
      auto pose =
          frontend_->process(frame->left, frame->right, static_cast<std::int64_t>(frame->index));
      if (!result.localization.empty()) pose.features = {};
      result.localization.push_back(std::move(pose));
    });
  });
  std::thread scene([&] {
    driver(Branch::scene).drive([&](const std::shared_ptr<const sensing::Frame>& frame) {
      const auto index = static_cast<std::int64_t>(frame->index);
      depth::DisparityMap map = depth_->process(frame->left, frame->right, index);
      result.scene.push_back({index, map.counts});
      sink(frame, std::move(map));
    });
  });
  localization.join();
  scene.join();
  result.stopped = progress.stopped();
  result.error = progress.error();
  return result;
}

}  // namespace partita::app
