// The calibration of one rectified stereo pair, from whichever of the usual files there is.
#ifndef PARTITA_HOST_TASKS_SENSING_STEREO_CALIBRATION_H
#define PARTITA_HOST_TASKS_SENSING_STEREO_CALIBRATION_H

#include <string>

#include "host/tasks/sensing/frame.h"

namespace partita::sensing {

/// A pair whose cameras may differ in cx: depth = fx * baseline / (disparity + disparity_offset).
struct PairCalibration {
  StereoCalibration camera;     ///< cx is the left one's; width and height 0 if the file has none
  double disparity_offset = 0;  ///< px: cx of the right camera less that of the left
};

/// Reads KITTI's projection matrices of cameras `left` and left + 1 (see kitti_calibration.h; also
/// named "P_rect_02:" as in its raw recordings), or Middlebury's "cam0=[fx 0 cx; 0 fy cy; 0 0 1]",
/// "cam1=...", "doffs=", "baseline=" in millimetres, "width=", "height=". Which of the two it is
/// follows from the content. Throws Error with file and line.
PairCalibration read_stereo_calibration(const std::string& path, int left);

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_STEREO_CALIBRATION_H
