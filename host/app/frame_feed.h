// FrameFeed: reads or renders each frame once, ahead of its consumers and on a thread of its own,
// and hands it to all of them. How far it is ahead is bounded; what the consumers get is not
// affected by who is quicker.
#ifndef PARTITA_HOST_APP_FRAME_FEED_H
#define PARTITA_HOST_APP_FRAME_FEED_H

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "host/tasks/sensing/frame.h"

namespace partita::app {

class FrameFeed {
 public:
  /// Whose position bounds how far the feed is ahead. `slowest` bounds the memory, and makes the
  /// quicker consumer wait; with `quickest` nobody ever waits for another consumer, which consumers
  /// that take turns among themselves must not.
  enum class Pace { slowest, quickest };

  /// `source` must outlive the feed. Consumers are numbered from 0.
  FrameFeed(const sensing::FrameSource& source, std::size_t frames, std::size_t consumers,
            Pace pace);
  ~FrameFeed();
  FrameFeed(const FrameFeed&) = delete;
  FrameFeed& operator=(const FrameFeed&) = delete;

  /// Waits for frame `index`. A consumer asks for ascending frames, and may leave some out.
  /// Rethrows what the source threw for that frame or an earlier one.
  std::shared_ptr<const sensing::Frame> get(std::size_t consumer, std::size_t index);
  /// The consumer wants no more frames: nobody waits for it any longer.
  void leave(std::size_t consumer);
  std::size_t size() const { return frames_; }

  /// FNV-1a 64 over the pixels of the first `count` frames (as far as they were produced), 16 hex
  /// digits: what the run has seen.
  std::string hash(std::size_t count) const;

 private:
  void produce();
  bool may_produce(std::size_t index) const;

  const sensing::FrameSource& source_;
  const std::size_t frames_;
  const Pace pace_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::size_t, std::shared_ptr<const sensing::Frame>> ready_;
  std::vector<std::size_t> position_;  ///< per consumer: the frame it asked for last
  std::vector<std::uint64_t> hashes_;  ///< running, after each frame
  std::size_t produced_ = 0;
  std::exception_ptr error_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_FRAME_FEED_H
