#include "host/app/frame_feed.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

namespace partita::app {
namespace {

constexpr std::size_t kAhead = 4;  ///< frames that the feed is ahead of a consumer
constexpr std::size_t kLeft = std::numeric_limits<std::size_t>::max();
constexpr std::uint64_t kFnvBasis = 0xcbf29ce484222325ULL;

std::uint64_t hash(std::uint64_t state, const sensing::GrayImage& image) {
  for (const std::uint8_t pixel : image.pixels) state = (state ^ pixel) * 0x100000001b3ULL;
  return state;
}

}  // namespace

FrameFeed::FrameFeed(const sensing::FrameSource& source, std::size_t frames, std::size_t consumers,
                     Pace pace)
    : source_(source), frames_(frames), pace_(pace), position_(consumers, 0), thread_([this] {
        produce();
      }) {}

FrameFeed::~FrameFeed() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool FrameFeed::may_produce(std::size_t index) const {
  std::size_t slowest = kLeft, quickest = 0;
  for (const std::size_t position : position_) {
    if (position == kLeft) continue;
    slowest = std::min(slowest, position);
    quickest = std::max(quickest, position);
  }
  if (slowest == kLeft) return false;
  return index < (pace_ == Pace::slowest ? slowest : quickest) + kAhead;
}

void FrameFeed::produce() {
  for (std::size_t index = 0; index < frames_; ++index) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stop_ || may_produce(index); });
      if (stop_) return;
    }
    std::shared_ptr<const sensing::Frame> frame;
    std::exception_ptr error;
    std::uint64_t state = hashes_.empty() ? kFnvBasis : hashes_.back();
    try {
      frame = std::make_shared<const sensing::Frame>(source_.frame(index));
      state = app::hash(app::hash(state, frame->left), frame->right);
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    if (error) {
      error_ = error;
    } else {
      ready_[index] = std::move(frame);
      hashes_.push_back(state);
      produced_ = index + 1;
    }
    changed_.notify_all();
    if (error) return;
  }
}

std::shared_ptr<const sensing::Frame> FrameFeed::get(std::size_t consumer, std::size_t index) {
  std::unique_lock lock(mutex_);
  position_[consumer] = index;
  ready_.erase(ready_.begin(),
               ready_.lower_bound(*std::min_element(position_.begin(), position_.end())));
  changed_.notify_all();
  changed_.wait(lock, [&] { return index < produced_ || error_ != nullptr; });
  if (index >= produced_) std::rethrow_exception(error_);
  return ready_.at(index);
}

void FrameFeed::leave(std::size_t consumer) {
  {
    const std::lock_guard lock(mutex_);
    position_[consumer] = kLeft;
  }
  changed_.notify_all();
}

std::string FrameFeed::hash(std::size_t count) const {
  const std::lock_guard lock(mutex_);
  const std::size_t known = std::min(count, hashes_.size());
  return fmt::format("{:016x}", known == 0 ? kFnvBasis : hashes_[known - 1]);
}

}  // namespace partita::app
