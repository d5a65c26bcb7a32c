#include "host/tasks/tracking/tracker.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/runtime/host_step.h"
#include "host/tasks/tracking/assignment.h"
#include "host/tasks/tracking/kernels.h"
#include "host/tasks/tracking/shapes.h"

namespace partita::tracking {
namespace {

constexpr double kSmallestBox = 3;  ///< px
constexpr double kLeastInside = 0.25;
constexpr double kWhollyInside = 0.9;  ///< share of a box: found boxes are not exact

void check_range(const char* name, double value, double least, double most) {
  if (value >= least && value <= most) return;  // false for NaN as well
  throw Error(fmt::format("tracking: {} is {}, expected {} to {}", name, value, least, most));
}

Target target_of(const Track& track) {
  return {track.slot, track.box, track.fresh};
}

}  // namespace

std::string_view to_string(End end) {
  switch (end) {
    case End::left_picture:
      return "left the picture";
    case End::lost:
      return "was lost";
    case End::missed:
      break;
  }
  return "was no longer detected";
}

void check_box(std::string_view what, const Box& box, int width, int height) {
  const auto fail = [&](const char* why) {
    throw Error(fmt::format("{}: box {:g},{:g},{:g},{:g} {} (picture {} x {})", what, box.x, box.y,
                            box.width, box.height, why, width, height));
  };
  for (const double value : {box.x, box.y, box.width, box.height}) {
    if (!std::isfinite(value)) fail("has a number that is not finite");
  }
  if (box.width < kSmallestBox || box.height < kSmallestBox) {
    fail("is too small, expected at least 3 x 3 px");
  }
  if (box.width > width || box.height > height) fail("is larger than the picture");
  if (visible_share(box, width, height) < kLeastInside) fail("lies outside the picture");
}

Tracker::Tracker(const runtime::Session& session, int width, int height,
                 const TrackerParameters& parameters)
    : session_(&session),
      parameters_(parameters),
      width_(width),
      height_(height),
      filters_(session, width, height, parameters.filter, parameters.capacity) {
  check_range("gate", parameters.gate, 0, 1);
  check_range("patience", parameters.patience, 0, 1000);
  check_range("least_visible", parameters.least_visible, 0, 1);
  check_range("least_response", parameters.least_response, 0, 1);
  check_range("collapse", parameters.collapse, 0, 1);
  check_range("inertia", parameters.inertia, 0, 1);
  for (int slot = parameters.capacity - 1; slot >= 0; --slot) free_slots_.push_back(slot);
}

void Tracker::update(const sensing::GrayImage& image,
                     std::optional<std::span<const Detection>> detections, std::int64_t frame) {
  if (detections) check(*detections);
  ended_.clear();
  refused_ = 0;
  counts_ = {};
  session_->extension().set_label("tracking", frame);
  filters_.look_at(image);
  follow();
  if (detections) associate(*detections);
  train();
  filters_.finish();
}

void Tracker::check(std::span<const Detection> detections) const {
  for (std::size_t i = 0; i < detections.size(); ++i) {
    check_box(fmt::format("detection {}", i), detections[i].box, width_, height_);
  }
}

/// Every track to where its filter finds it; those that are gone end.
void Tracker::follow() {
  std::vector<Target> expected;
  for (Track& track : tracks_) {
    track.fresh = false;
    Target target = target_of(track);
    target.box.x += track.velocity_x;
    target.box.y += track.velocity_y;
    expected.push_back(target);
  }
  const std::vector<Located> found = filters_.locate(expected);
  counts_.located = static_cast<std::int64_t>(expected.size());
  counts_.locate_samples = expected.empty() ? 0 : filters_.samples();
  std::vector<Track> kept;
  for (std::size_t i = 0; i < found.size(); ++i) {
    Track track = tracks_[i];
    const double way_x = found[i].box.centre_x() - track.box.centre_x();
    const double way_y = found[i].box.centre_y() - track.box.centre_y();
    const double inertia = parameters_.inertia;
    track.velocity_x = inertia * track.velocity_x + (1 - inertia) * way_x;
    track.velocity_y = inertia * track.velocity_y + (1 - inertia) * way_y;
    track.box = found[i].box;
    track.response = found[i].response;
    if (has_left(track)) {
      end_track(track, End::left_picture);
    } else if (!(track.response >= parameters_.least_response)) {
      end_track(track, End::lost);
    } else {
      if (visible_share(track.box, width_, height_) >= kWhollyInside) {
        const double usual = track.usual_response;
        track.usual_response = usual > 0 ? 0.9 * usual + 0.1 * track.response : track.response;
      }
      kept.push_back(track);
    }
  }
  tracks_ = std::move(kept);
}

bool Tracker::has_left(const Track& track) const {
  const double visible = visible_share(track.box, width_, height_);
  if (visible < parameters_.least_visible) return true;
  return visible < kWhollyInside && track.response < parameters_.collapse * track.usual_response;
}

void Tracker::associate(std::span<const Detection> detections) {
  counts_.detected = true;
  counts_.tracks = static_cast<std::int64_t>(tracks_.size());
  counts_.detections = static_cast<std::int64_t>(detections.size());
  std::vector<double> costs;
  for (const Track& track : tracks_) {
    for (const Detection& detection : detections) {
      const double common = overlap(track.box, detection.box);
      // A pair that is not allowed costs as much as staying alone.
      costs.push_back(common >= parameters_.gate && common > 0 ? 1 - common : 1);
    }
  }
  const auto detection_of = assign(costs, tracks_.size(), detections.size());
  declare_host_step(*session_, associate_spec(),
                    associate_shape(counts_.tracks, counts_.detections));
  std::vector<bool> taken(detections.size());
  std::vector<Track> kept;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    Track track = tracks_[t];
    const auto d = detection_of[t];
    if (d && costs[t * detections.size() + *d] < 1) {
      taken[*d] = true;
      track.box = detections[*d].box;
      track.score = detections[*d].score;
      track.label = detections[*d].label;
      track.misses = 0;
    } else if (++track.misses > parameters_.patience) {
      end_track(track, End::missed);
      continue;
    }
    kept.push_back(track);
  }
  tracks_ = std::move(kept);
  for (std::size_t d = 0; d < detections.size(); ++d) {
    if (!taken[d] && detections[d].score >= parameters_.start_score) start(detections[d]);
  }
}

void Tracker::start(const Detection& detection) {
  if (free_slots_.empty()) {
    ++refused_;
    return;
  }
  Track track;
  track.id = next_id_++;
  track.box = detection.box;
  track.label = detection.label;
  track.score = detection.score;
  track.slot = free_slots_.back();
  free_slots_.pop_back();
  tracks_.push_back(track);
}

void Tracker::end_track(const Track& track, End why) {
  free_slots_.push_back(track.slot);
  ended_.push_back({track, why});
}

void Tracker::train() {
  std::vector<Target> targets;
  for (const Track& track : tracks_) targets.push_back(target_of(track));
  filters_.train(targets);
  counts_.trained = static_cast<std::int64_t>(targets.size());
  counts_.train_samples = targets.empty() ? 0 : filters_.samples();
}

}  // namespace partita::tracking
