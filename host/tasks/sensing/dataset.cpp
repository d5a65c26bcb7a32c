#include "host/tasks/sensing/dataset.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "host/io/output_folder.h"
#include "host/runtime/error.h"
#include "host/tasks/sensing/drive_csv.h"
#include "host/tasks/sensing/sensor_files.h"

namespace partita::sensing {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> csv_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code code;
  for (auto it = fs::directory_iterator(folder, code); !code && it != fs::directory_iterator();
       it.increment(code)) {
    if (it->path().extension() == ".csv" && it->path().filename().string()[0] != '.') {
      files.push_back(it->path());
    }
  }
  if (code) throw Error(fmt::format("cannot read '{}': {}", folder.string(), code.message()));
  std::sort(files.begin(), files.end());
  return files;
}

/// Of several files, those whose columns make up a drive: one with both, or one of each.
std::vector<fs::path> choose_csv(const std::string& folder, std::vector<std::string>& notices) {
  std::vector<fs::path> both, imu, gps;
  for (const fs::path& path : csv_files(folder)) {
    CsvContents contents;
    try {
      contents = csv_contents(io::CsvFile(path.string()));
    } catch (const Error& error) {
      // What is meant as the drive must be readable; another table need not be.
      const std::string name = path.filename().string();
      if (name == "imu.csv" || name == "gps.csv") throw;
      notices.push_back(fmt::format("not a drive: {}", error.what()));
      continue;
    }
    if (!contents.time) continue;
    if (contents.imu && contents.gps)
      both.push_back(path);
    else if (contents.imu)
      imu.push_back(path);
    else if (contents.gps)
      gps.push_back(path);
  }
  const auto one = [&](const std::vector<fs::path>& files, const char* what) {
    if (files.size() < 2) return;
    throw Error(fmt::format("data set '{}': {} and {} both hold {}; name the file", folder,
                            files[0].filename().string(), files[1].filename().string(), what));
  };
  if (!imu.empty()) {
    one(imu, "inertial readings");
    one(gps, "positions");
    if (!gps.empty()) return {imu[0], gps[0]};
    return {imu[0]};
  }
  one(both, "a drive");
  if (!both.empty()) return both;
  throw Error(
      fmt::format("data set '{}': expected pictures (KITTI, EuRoC) or a CSV file with inertial "
                  "readings",
                  folder));
}

}  // namespace

Dataset open_drive_csv(const std::string& path) {
  Dataset dataset;
  dataset.kind = "CSV";
  std::vector<fs::path> files{path};
  if (fs::is_directory(path)) files = choose_csv(path, dataset.log.notices);
  std::optional<LocalMap> origin;
  for (const fs::path& file : files) read_drive_csv(file.string(), dataset.log, origin);
  if (dataset.log.imu.empty()) {
    throw Error(fmt::format("{}: no inertial reading that can be used", files.front().string()));
  }
  settle_conventions(dataset.log);
  measure_noise(dataset.log);
  return dataset;
}

Dataset open_kitti_odometry(const std::string& folder) {
  Dataset dataset;
  dataset.kind = "KITTI odometry";
  dataset.frames = open_kitti(folder);
  const fs::path imu = fs::path(folder) / "imu.csv", gps = fs::path(folder) / "gps.csv";
  std::optional<LocalMap> origin;
  if (fs::exists(imu)) read_drive_csv(imu.string(), dataset.log, origin);
  if (fs::exists(gps)) read_drive_csv(gps.string(), dataset.log, origin);
  measure_noise(dataset.log);
  dataset.log.R_imu_vehicle = vehicle_in_camera_axes();
  if (const auto poses = dataset.frames->true_poses()) {
    for (std::size_t i = 0; i < poses->size(); ++i) {
      dataset.log.truth.push_back({dataset.frames->timestamp_ns(i), (*poses)[i], {}, {}, {}});
    }
  }
  return dataset;
}

Dataset open_dataset(const std::string& path) {
  const fs::path folder = path;
  if (fs::is_regular_file(folder)) return open_drive_csv(path);
  if (!fs::is_directory(folder)) throw Error(fmt::format("data set '{}': no such folder", path));
  if (io::is_partial(path)) {
    throw Error(
        fmt::format("data set '{}': incomplete, its writing was interrupted (it holds the "
                    "mark PARTIAL)",
                    path));
  }
  if (fs::is_directory(folder / "mav0") || fs::is_directory(folder / "imu0")) {
    return open_euroc(path);
  }
  if (fs::exists(folder / "image_00" / "timestamps.txt")) return open_kitti_raw(path);
  for (const char* name : {"image_0", "image_l", "image_2"}) {
    if (fs::is_directory(folder / name)) return open_kitti_odometry(path);
  }
  return open_drive_csv(path);
}

}  // namespace partita::sensing
