// Tracks: made from detections, followed by their filters on every frame, associated with new
// detections, and ended. Ids are stable and never used twice.
//
// On every frame each target is looked for around where its velocity takes it. On frames with
// detections, tracks and detections are put together so that the sum of their overlaps is largest
// (assignment.h), pairs that overlap too little excluded. A track that got one takes its box, a
// detection without a track starts one, and a track that has gone without for too many such frames
// in a row ends. So does one whose filter no longer answers, and one whose target leaves the
// picture: filters hold on to a picture's edge, so that what tells is a box across the edge whose
// response collapses, before the box itself is outside.
#ifndef PARTITA_HOST_TASKS_TRACKING_TRACKER_H
#define PARTITA_HOST_TASKS_TRACKING_TRACKER_H

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "host/tasks/tracking/counts.h"
#include "host/tasks/tracking/filters.h"

namespace partita::tracking {

struct Detection {
  Box box;
  double score = 0;
  int label = 0;  ///< the detector's class
};

struct TrackerParameters {
  FilterParameters filter;
  int capacity = 64;         ///< most targets at a time; 1..1024
  double gate = 0.3;         ///< least overlap of a track with its detection; 0..1
  double start_score = 0.3;  ///< least score of a detection that starts a track
  int patience = 3;          ///< frames with detections that a track survives without one; 0..1000
  double least_visible = 0.25;   ///< share of a box that has to lie in the picture; 0..1
  double least_response = 0.05;  ///< of a filter that has not lost its target; 0..1
  double collapse = 0.5;         ///< of the usual response, at the picture's edge; 0..1
  double inertia = 0.5;          ///< share of the old velocity in the new one; 0..1
};

enum class End { left_picture, lost, missed };
std::string_view to_string(End end);  ///< "left the picture" and so on

struct Track {
  int id = 0;  ///< from 1
  Box box;
  int label = 0;
  double score = 0;           ///< of its last detection
  double response = 1;        ///< of its filter in this frame
  double usual_response = 0;  ///< its running mean, while wholly in the picture; 0: not yet
  double velocity_x = 0, velocity_y = 0;  ///< px a frame
  int misses = 0;  ///< frames with detections since the last one that was its own
  std::int32_t slot = 0;
  bool fresh = true;  ///< made in this frame
};

struct Ended {
  Track track;
  End why = End::lost;
};

class Tracker {
 public:
  /// Throws Error for a parameter out of range or pictures that Filters does not take.
  Tracker(const runtime::Session& session, int width, int height,
          const TrackerParameters& parameters = {});

  /// The next frame; `detections` where the detector ran, in any order. Throws Error for a box
  /// that is not of finite numbers, has no area, or lies outside the picture, and for a picture of
  /// another size. Returns when the device has finished. `frame` is what it is recorded as.
  void update(const sensing::GrayImage& image,
              std::optional<std::span<const Detection>> detections = std::nullopt,
              std::int64_t frame = 0);

  const std::vector<Track>& tracks() const { return tracks_; }  ///< alive now, by id
  const std::vector<Ended>& ended() const { return ended_; }    ///< in the last update
  /// Detections of the last update that found no free place.
  int refused() const { return refused_; }
  const FrameCounts& counts() const { return counts_; }

  void warm_up() { filters_.warm_up(); }

 private:
  void check(std::span<const Detection> detections) const;
  void follow();
  void associate(std::span<const Detection> detections);
  void start(const Detection& detection);
  bool has_left(const Track& track) const;
  void end_track(const Track& track, End why);
  void train();

  const runtime::Session* session_;
  TrackerParameters parameters_;
  int width_, height_;
  Filters filters_;
  std::vector<Track> tracks_;
  std::vector<Ended> ended_;
  std::vector<std::int32_t> free_slots_;
  int next_id_ = 1;
  int refused_ = 0;
  FrameCounts counts_;
};

/// Throws Error, beginning with `what`, unless the box is of finite numbers, at least 3 px wide and
/// high, no larger than the picture, and with a quarter of its area at least inside.
void check_box(std::string_view what, const Box& box, int width, int height);

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_TRACKER_H
