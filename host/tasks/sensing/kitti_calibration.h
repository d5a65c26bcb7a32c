// The calibration file of a KITTI odometry sequence.
#ifndef PARTITA_HOST_TASKS_SENSING_KITTI_CALIBRATION_H
#define PARTITA_HOST_TASKS_SENSING_KITTI_CALIBRATION_H

#include <string>

#include "host/tasks/sensing/frame.h"

namespace partita::sensing {

/// Reads the projection matrices of cameras `left` and left + 1: lines "P0: ..." (or, as in the raw
/// recordings, "P_rect_00: ...") with twelve numbers each, or, without any names, the file's first
/// two lines. Other named lines are skipped.
/// Width and height are not in the file and stay 0. Throws Error with file and line for what does
/// not parse, and for two cameras that are no rectified pair (same intrinsics, right one at +x).
StereoCalibration read_kitti_calibration(const std::string& path, int left);

/// Writes P0 and P1 such that reading them gives the same calibration.
void write_kitti_calibration(const std::string& path, const StereoCalibration& calibration);

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_KITTI_CALIBRATION_H
