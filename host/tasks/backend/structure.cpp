#include "host/tasks/backend/structure.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/tasks/backend/layout.h"

namespace partita::backend {
namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

void check(const Problem& problem) {
  const auto fail = [](std::size_t i, const char* what, int index, std::size_t count) {
    throw Error(fmt::format("observation {}: {} {}, expected 0 to {}", i, what, index, count - 1));
  };
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const Observation& o = problem.observations[i];
    if (o.camera < 0 || at(o.camera) >= problem.cameras.size()) {
      fail(i, "camera", o.camera, problem.cameras.size());
    }
    if (o.point < 0 || at(o.point) >= problem.points.size()) {
      fail(i, "point", o.point, problem.points.size());
    }
  }
  constexpr std::size_t kMost = 1u << 30;
  if (problem.observations.size() + kLanes * problem.cameras.size() > kMost ||
      problem.points.size() * 3 > kMost) {
    throw Error("bundle adjustment: more observations or points than 2^30");
  }
}

/// Indices sorted by key, stably; starts[k]: first of key k, one more at the end.
template <class Key>
std::vector<int> counting_sort(const std::vector<int>& order, int keys, Key key,
                               std::vector<int>& starts) {
  starts.assign(at(keys) + 1, 0);
  for (const int i : order) ++starts[at(key(i)) + 1];
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<int> next(starts.begin(), starts.end() - 1), sorted(order.size());
  for (const int i : order) sorted[at(next[at(key(i))]++)] = i;
  return sorted;
}

void make_slots(const Problem& problem, Structure& s) {
  std::vector<int> order(problem.observations.size()), starts;
  std::iota(order.begin(), order.end(), 0);
  const auto point = [&](int i) { return problem.observations[at(i)].point; };
  const auto camera = [&](int i) { return problem.observations[at(i)].camera; };
  order = counting_sort(order, s.points, point, starts);
  order = counting_sort(order, s.cameras, camera, starts);
  for (int c = 0; c < s.cameras; ++c) {
    s.camera_chunks.push_back(static_cast<int>(s.chunks.size()));
    const int first = static_cast<int>(s.slot_observation.size());
    for (int i = starts[at(c)]; i < starts[at(c) + 1]; ++i) {
      s.slot_observation.push_back(order[at(i)]);
      s.slot_point.push_back(point(order[at(i)]));
    }
    while (s.slot_observation.size() % kLanes != 0) {
      s.slot_observation.push_back(-1);
      s.slot_point.push_back(s.slot_point.back());
    }
    const int end = static_cast<int>(s.slot_observation.size());
    for (int i = first; i < end; i += kChunk)
      s.chunks.push_back({c, i, std::min(kChunk, end - i), 0});
  }
  s.camera_chunks.push_back(static_cast<int>(s.chunks.size()));
  s.slots = static_cast<int>(s.slot_observation.size());
}

void make_point_lists(const Problem& problem, Structure& s) {
  std::vector<int> real;
  real.reserve(problem.observations.size());
  for (int i = 0; i < s.slots; ++i) {
    if (s.slot_observation[at(i)] >= 0) real.push_back(i);
  }
  s.point_slots = counting_sort(
      real, s.points, [&](int i) { return s.slot_point[at(i)]; }, s.point_start);
  s.point_cameras.reserve(real.size());
  for (const int slot : s.point_slots) {
    s.point_cameras.push_back(problem.observations[at(s.slot_observation[at(slot)])].camera);
  }
}

/// The pairs of one camera: counted per other camera, then filled in, points ascending.
class PairBuilder {
 public:
  PairBuilder(const Problem& problem, Structure& s)
      : problem_(problem), s_(s), next_(at(s.cameras), 0) {}

  void build() {
    for (int c = 0; c < s_.cameras; ++c) {
      const int first = s_.camera_chunks[at(c)], end = s_.camera_chunks[at(c) + 1];
      begin_ = first == end ? 0 : s_.chunks[at(first)][1];
      end_ = first == end ? 0 : s_.chunks[at(end) - 1][1] + s_.chunks[at(end) - 1][2];
      add(c);
    }
  }

 private:
  bool fixed(int camera) const { return !problem_.fixed.empty() && problem_.fixed[at(camera)]; }

  /// visit(slot, other slot, other camera) for every two slots of a point, the first of them this
  /// camera's, the other one's camera the same or a later one.
  template <class Visit>
  void each(int camera, Visit visit) const {
    for (int slot = begin_; slot < end_; ++slot) {
      if (s_.slot_observation[at(slot)] < 0) continue;
      const int point = s_.slot_point[at(slot)];
      const int last = s_.point_start[at(point) + 1];
      for (int i = last - 1; i >= s_.point_start[at(point)]; --i) {
        const int other = s_.point_cameras[at(i)];
        if (other < camera) break;
        if (!fixed(other)) visit(slot, s_.point_slots[at(i)], other);
      }
    }
  }

  void add(int camera) {
    std::vector<int> others;
    const auto count = [&](int, int, int other) {
      if (next_[at(other)]++ == 0) others.push_back(other);
    };
    if (!fixed(camera)) each(camera, count);
    if (next_[at(camera)] == 0) others.push_back(camera);
    std::sort(others.begin(), others.end());
    std::size_t total = s_.entries.size();
    for (const int other : others) {
      const std::size_t begin = total;
      total += at(next_[at(other)]);
      if (total > static_cast<std::size_t>(std::numeric_limits<int>::max() / 2)) {
        throw Error("bundle adjustment: more than 2^30 pairs of observations of a point");
      }
      s_.pairs.push_back({static_cast<int>(begin), static_cast<int>(total), camera, other});
      next_[at(other)] = static_cast<int>(begin);
    }
    s_.entries.resize(total);
    if (!fixed(camera)) {
      each(camera, [&](int slot, int other_slot, int other) {
        s_.entries[at(next_[at(other)]++)] = {slot, other_slot};
      });
    }
    for (const int other : others) next_[at(other)] = 0;
  }

  const Problem& problem_;
  Structure& s_;
  std::vector<int> next_;
  int begin_ = 0, end_ = 0;
};

}  // namespace

Structure make_structure(const Problem& problem) {
  check(problem);
  Structure s;
  s.cameras = static_cast<int>(problem.cameras.size());
  s.points = static_cast<int>(problem.points.size());
  make_slots(problem, s);
  make_point_lists(problem, s);
  PairBuilder(problem, s).build();
  return s;
}

}  // namespace partita::backend
