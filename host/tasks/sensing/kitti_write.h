// Writes any frame source as a KITTI odometry folder.
#ifndef PARTITA_HOST_TASKS_SENSING_KITTI_WRITE_H
#define PARTITA_HOST_TASKS_SENSING_KITTI_WRITE_H

#include <cstddef>
#include <functional>
#include <string>

#include "host/tasks/sensing/frame.h"

namespace partita::sensing {

/// Writes image_0/ image_1/ calib.txt times.txt, and what the source knows of: poses.txt,
/// disparity/ (16-bit truth), label_2/ (boxes, KITTI's object format; what a 2D box does not know
/// has KITTI's "unknown" values; what shows less than 20 rows or a quarter of itself is DontCare),
/// imu.csv, gps.csv. Every file is whole or absent, and the folder holds the mark PARTIAL until all
/// are there. `progress(done, size)` is called after each frame; whatever it throws ends the
/// writing.
void write_kitti(const FrameSource& source, const std::string& folder,
                 const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_KITTI_WRITE_H
