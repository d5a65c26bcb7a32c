#include "devices/timeline/calendar.h"

#include <algorithm>
#include <stdexcept>

namespace partita::timeline {
namespace {

/// std::upper_bound for questions about times near the end, which nearly all are: doubling steps
/// from the back bracket the answer, then it is searched for in there.
template <typename T, typename Later>
typename std::vector<T>::const_iterator upper_bound_from_back(const std::vector<T>& all, Ns time,
                                                              const Later& later) {
  auto high = all.end();
  for (std::ptrdiff_t step = 1; high != all.begin(); step *= 2) {
    const auto low = high - std::min(step, high - all.begin());
    if (!later(time, *low)) return std::upper_bound(low + 1, high, time, later);
    high = low;
  }
  return high;
}

}  // namespace

std::vector<BusyTimes::Interval>::const_iterator BusyTimes::first_ending_after(Ns time) const {
  return upper_bound_from_back(busy_, time, [](Ns t, const Interval& i) { return t < i.end; });
}

Ns BusyTimes::first_gap(Ns start, Ns duration) const {
  for (auto it = first_ending_after(start); it != busy_.end(); ++it) {
    if (start <= it->start && it->start - start >= duration) return start;
    start = it->end;
  }
  return start;
}

void BusyTimes::insert(Ns start, Ns end) {
  if (start < floor_) throw std::logic_error("timeline: a reservation in the closed past");
  if (busy_.empty() || start > busy_.back().end) {
    busy_.push_back({start, end});
    if (busy_.size() > kMaxGaps) close_before(busy_[busy_.size() / 2].start);
    return;
  }
  const auto next = busy_.begin() + (first_ending_after(start) - busy_.begin());
  if (next == busy_.end() || next->start < end) {
    throw std::logic_error("timeline: an engine used twice at once");
  }
  const bool joins_next = next->start == end;
  const bool joins_previous = next != busy_.begin() && (next - 1)->end == start;
  if (joins_next && joins_previous) {
    (next - 1)->end = next->end;
    busy_.erase(next);
  } else if (joins_next) {
    next->start = start;
  } else if (joins_previous) {
    (next - 1)->end = end;
  } else {
    busy_.insert(next, {start, end});
    if (busy_.size() > kMaxGaps) close_before(busy_[busy_.size() / 2].start);
  }
}

void BusyTimes::clear() {
  busy_.clear();
  floor_ = 0;
}

void BusyTimes::close_before(Ns time) {
  floor_ = std::max(floor_, time);
  busy_.erase(busy_.begin(), first_ending_after(floor_));
}

std::size_t Bandwidth::step_at(Ns time) const {
  const auto after =
      upper_bound_from_back(steps_, time, [](Ns t, const Step& s) { return t < s.from; });
  return static_cast<std::size_t>(after - steps_.begin()) - 1;
}

std::uint32_t Bandwidth::used(Ns time) const {
  if (steps_.empty() || time < steps_.front().from) return 0;
  return steps_[step_at(time)].used;
}

Ns Bandwidth::stretched(Ns start, Ns busy, std::uint32_t share) const {
  Ns now = start;
  std::uint64_t left = busy * share;  // share x ns; busy < 2^42 and share <= 2^20
  std::size_t i = now < steps_.front().from ? 0 : step_at(now) + 1;  // the step after `now`
  std::uint32_t used_now = i == 0 ? 0 : steps_[i - 1].used;
  while (left > 0) {
    const std::uint64_t rate = std::min(share, kWhole - used_now);
    if (i == steps_.size()) return now + (left + rate - 1) / rate;
    const std::uint64_t span = steps_[i].from - now;
    if (rate > 0 && (left + rate - 1) / rate <= span) return now + (left + rate - 1) / rate;
    left -= rate * span;
    now = steps_[i].from;
    used_now = steps_[i++].used;
  }
  return now;
}

std::size_t Bandwidth::split(Ns time) {
  if (steps_.empty() || time < steps_.front().from) {
    steps_.insert(steps_.begin(), {time, 0});
    return 0;
  }
  const std::size_t at = step_at(time);
  if (steps_[at].from == time) return at;
  steps_.insert(steps_.begin() + static_cast<std::ptrdiff_t>(at) + 1, {time, steps_[at].used});
  return at + 1;
}

/// Nothing is taken from `start` on.
void Bandwidth::append(Ns start, Ns end, std::uint32_t share) {
  if (!steps_.empty() && steps_.back().from == start) {
    steps_.back().used = share;
    const std::size_t n = steps_.size();
    if (n > 1 && steps_[n - 2].used == share) steps_.pop_back();  // goes on as before
  } else {
    steps_.push_back({start, share});
  }
  steps_.push_back({end, 0});
  drop_oldest();
}

/// Bounds memory: what is older than the later half is closed.
void Bandwidth::drop_oldest() {
  if (steps_.size() <= kMaxGaps) return;
  const auto keep = steps_.begin() + kMaxGaps / 2;
  floor_ = std::max(floor_, keep->from);
  steps_.erase(steps_.begin(), keep);
}

void Bandwidth::reserve(Ns start, Ns end, std::uint32_t share) {
  if (start >= end || share == 0) return;
  if (share > kWhole) throw std::logic_error("timeline: more than the whole bandwidth");
  if (steps_.empty() || start >= steps_.back().from) return append(start, end, share);
  const std::size_t first = split(start);
  const std::size_t last = split(end);
  for (std::size_t i = first; i < last; ++i) {
    steps_[i].used += std::min(share, kWhole - steps_[i].used);
  }
  // Steps of equal use need no border between them; only those around here can have become equal.
  const auto equal = [](const Step& a, const Step& b) { return a.used == b.used; };
  const auto from = steps_.begin() + static_cast<std::ptrdiff_t>(first > 0 ? first - 1 : 0);
  const auto to = steps_.begin() + static_cast<std::ptrdiff_t>(last) + 1;
  steps_.erase(std::unique(from, to, equal), to);
  drop_oldest();
}

void Bandwidth::clear() {
  steps_.clear();
  floor_ = 0;
}

}  // namespace partita::timeline
