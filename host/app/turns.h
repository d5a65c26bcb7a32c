// Turns: lets host threads act one after the other in the order of their virtual time, so that what
// one of them decides by the predicted clock (dropping a late frame) does not depend on which of
// them this computer happened to run first.
#ifndef PARTITA_HOST_APP_TURNS_H
#define PARTITA_HOST_APP_TURNS_H

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

namespace partita::app {

class Turns {
 public:
  explicit Turns(std::size_t threads) : waiting_(threads), left_(threads, false) {}

  /// Ends this thread's turn, and returns when every other thread waits with a later time (equal
  /// times: a larger index) or has left.
  void wait_turn(std::size_t index, std::uint64_t time) {
    std::unique_lock lock(mutex_);
    waiting_[index] = time;
    changed_.notify_all();
    changed_.wait(lock, [&] { return first(index, time); });
    waiting_[index].reset();
  }
  void leave(std::size_t index) {
    {
      const std::lock_guard lock(mutex_);
      left_[index] = true;
    }
    changed_.notify_all();
  }

 private:
  bool first(std::size_t index, std::uint64_t time) const {
    for (std::size_t other = 0; other < waiting_.size(); ++other) {
      if (other == index || left_[other]) continue;
      if (!waiting_[other]) return false;
      if (*waiting_[other] < time || (*waiting_[other] == time && other < index)) return false;
    }
    return true;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::optional<std::uint64_t>> waiting_;
  std::vector<bool> left_;
};

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_TURNS_H
