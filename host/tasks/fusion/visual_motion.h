// What the front-end says of the camera's motion, as fusion takes it.
#ifndef PARTITA_HOST_TASKS_FUSION_VISUAL_MOTION_H
#define PARTITA_HOST_TASKS_FUSION_VISUAL_MOTION_H

#include "host/tasks/frontend/frontend.h"
#include "host/tasks/fusion/drive.h"

namespace partita::fusion {

/// Information of a camera's motion from the landmarks that agree with it: with P a landmark in the
/// later camera's axes, a change (d, e) of the motion on its right moves it by hat(P) d - e, and so
/// its pixel; the pixel's covariance is that of a refined match and of the landmark's depth, which
/// the disparity's error dominates. A share of it only: matches have errors in common (the
/// calibration's, the road's shine), so that many of them are not that many independent ones.
Matrix6d motion_information(const std::vector<frontend::Feature>& features,
                            const sensing::StereoCalibration& calibration);

/// Turns the front-end's results, frame by frame, into what the estimator takes. With no inertial
/// unit, a frame that was not tracked gets the front-end's guess (the last motion once more), at
/// little weight.
class VisualTrack {
 public:
  VisualTrack(const sensing::StereoCalibration& calibration, bool guess)
      : calibration_(calibration), guess_(guess) {}
  void add(const frontend::FrontendResult& result, std::int64_t timestamp_ns);
  const std::vector<VisualFrame>& frames() const { return frames_; }
  std::size_t lost() const { return lost_; }

 private:
  sensing::StereoCalibration calibration_;
  bool guess_;
  std::vector<VisualFrame> frames_;
  std::vector<std::int64_t> numbers_;  ///< the front-end's, of each
  std::size_t lost_ = 0;
};

}  // namespace partita::fusion

#endif  // PARTITA_HOST_TASKS_FUSION_VISUAL_MOTION_H
