// A drive to be localized, whatever form it has on disk.
#ifndef PARTITA_HOST_TASKS_SENSING_DATASET_H
#define PARTITA_HOST_TASKS_SENSING_DATASET_H

#include <memory>
#include <string>

#include "host/tasks/sensing/frame.h"
#include "host/tasks/sensing/sensor_log.h"

namespace partita::sensing {

struct Dataset {
  std::string kind;  ///< "KITTI odometry", "KITTI raw", "EuRoC", "CSV", "scenario"
  std::unique_ptr<FrameSource> frames;  ///< null: no pictures
  SensorLog log;
};

/// What lies in the folder says which form it has: mav0/ or imu0/ (EuRoC), image_00/timestamps.txt
/// (KITTI raw), images as KITTI odometry's, or CSV files alone; a single CSV file is taken, too.
/// Throws Error where it is none of these or something in it cannot be read.
Dataset open_dataset(const std::string& path);

Dataset open_euroc(const std::string& folder);
Dataset open_kitti_raw(const std::string& folder);
Dataset open_drive_csv(const std::string& path);
Dataset open_kitti_odometry(const std::string& folder);
Dataset open_scenario_drive(const ScenarioOptions& options);

}  // namespace partita::sensing

#endif  // PARTITA_HOST_TASKS_SENSING_DATASET_H
