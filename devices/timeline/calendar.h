// When an engine is busy, and how much of a memory's bandwidth is taken. Inside the timeline only.
#ifndef PARTITA_DEVICES_TIMELINE_CALENDAR_H
#define PARTITA_DEVICES_TIMELINE_CALENDAR_H

#include <cstdint>
#include <vector>

#include "devices/timeline/layout.h"

namespace partita::timeline {

/// Gaps that are kept per calendar. Beyond, the older half is closed: nothing starts before it any
/// more. It bounds memory, and depends on nothing but the sequence of reservations.
inline constexpr std::size_t kMaxGaps = 1024;

/// The busy intervals of one engine; intervals that touch are merged.
class BusyTimes {
 public:
  /// The earliest start >= ready of a free stretch of `duration`. Mostly nothing is taken later.
  Ns first_fit(Ns ready, Ns duration) const {
    const Ns start = ready < floor_ ? floor_ : ready;
    return busy_.empty() || start >= busy_.back().end ? start : first_gap(start, duration);
  }
  /// Whether nothing but one unbroken stretch, or nothing, is taken from `ready` on; then `start` is
  /// when it is over.
  bool unbroken_from(Ns ready, Ns& start) const {
    start = ready < floor_ ? floor_ : ready;
    if (busy_.empty() || start >= busy_.back().end) return true;
    const bool unbroken = start >= busy_.back().start;
    start = busy_.back().end;
    return unbroken;
  }
  /// Throws std::logic_error if any of [start, end) is taken: an engine does one thing at a time.
  void reserve(Ns start, Ns end) {
    if (start >= end) return;
    if (!busy_.empty() && start == busy_.back().end) {
      busy_.back().end = end;
    } else {
      insert(start, end);
    }
  }
  void clear();
  /// Nothing may start before `time` any more.
  void close_before(Ns time);
  struct Interval {
    Ns start, end;
  };
  const std::vector<Interval>& all() const { return busy_; }

 private:
  Ns first_gap(Ns start, Ns duration) const;
  void insert(Ns start, Ns end);
  std::vector<Interval>::const_iterator first_ending_after(Ns time) const;

  std::vector<Interval> busy_;
  Ns floor_ = 0;
};

/// The used share of a memory's bandwidth over time. A command draws a constant share when alone;
/// where less is left it draws that and takes longer. Reservations never change afterwards.
class Bandwidth {
 public:
  static constexpr std::uint32_t kWhole = 1u << 20;

  /// Earliest time >= ready that is still open.
  Ns open_from(Ns ready) const { return ready < floor_ ? floor_ : ready; }
  /// END of a command that starts at `start`, needs `busy` ns alone and then draws `share`.
  /// Integers throughout: `busy` x `share` is what it has to draw, to the unit.
  Ns stretched_end(Ns start, Ns busy, std::uint32_t share) const {
    return idle_from(start) || share == 0 ? start + busy : stretched(start, busy, share);
  }
  /// Takes min(share, what is left) over [start, end). Throws std::logic_error above the whole.
  void reserve(Ns start, Ns end, std::uint32_t share);
  void clear();
  /// Whether nothing is taken from `time` on.
  bool idle_from(Ns time) const { return steps_.empty() || time >= steps_.back().from; }
  /// Used share at a time.
  std::uint32_t used(Ns time) const;
  struct Step {
    Ns from;
    std::uint32_t used;  ///< until the next step; the last one is 0 for ever
  };
  const std::vector<Step>& all() const { return steps_; }

 private:
  Ns stretched(Ns start, Ns busy, std::uint32_t share) const;
  std::size_t step_at(Ns time) const;  ///< index of the step that holds `time`; steps not empty
  std::size_t split(Ns time);          ///< makes a step begin at `time`
  void append(Ns start, Ns end, std::uint32_t share);
  void drop_oldest();

  std::vector<Step> steps_;
  Ns floor_ = 0;
};

}  // namespace partita::timeline

#endif  // PARTITA_DEVICES_TIMELINE_CALENDAR_H
