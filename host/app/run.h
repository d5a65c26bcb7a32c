// What `partita run` was asked, and what came of it; see run_command.cpp for the order of things.
#ifndef PARTITA_HOST_APP_RUN_H
#define PARTITA_HOST_APP_RUN_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "devices/profile/machine.h"
#include "devices/timeline/schedule.h"
#include "host/app/console.h"
#include "host/app/depth_output.h"
#include "host/app/pipeline.h"
#include "host/io/trajectory_error.h"
#include "partition/summary.h"

namespace partita::app {

struct RunOptions {
  std::string dataset;  ///< empty: the built-in scenario
  std::string machine = "dragonfly";
  std::string placement;
  std::string container;   ///< empty: packaged for the machine
  std::string execute;     ///< own, fast or empty: fast where the devices are emulated
  std::size_t frames = 0;  ///< 0: all of them
  std::string out = "partita-out";
  bool force = false;
  double rate_hz = 0;  ///< 0: as the source's time stamps say
  std::uint64_t seed = 1;
  int width = 1280, height = 720;
  bool drop_late = false;
  bool allow_source = false;
  std::string fault;
};

/// Predicted figures, all from the canonical replay of the record.
struct Prediction {
  profile::Machine machine;
  timeline::Record record;
  timeline::Schedule schedule;
  partition::Summary summary;
};

struct Measurement {
  double start_up_s = 0;  ///< from the process's start to the first frame's
  double warm_up_s = 0;   ///< the part of it that ran every kernel once
  double total_s = 0;     ///< from the first frame's start to the last frame's end
};

struct Accuracy {
  std::optional<io::TrajectoryError> trajectory;
  DepthAccuracy depth;
};

/// Everything that the reports are made of.
struct RunReport {
  const RunOptions& options;
  const Pipeline& pipeline;
  const sensing::FrameSource& source;
  const PipelineRun& run;
  partition::Placement placement;
  runtime::Execute execute;
  std::size_t frames = 0;  ///< that every branch is done with
  std::string input_hash;
  double rate_hz = 0;
  Measurement measured;
  Accuracy accuracy;
  std::optional<Prediction> prediction;  ///< absent without an emulated machine
  std::vector<std::string> files;

  /// "localization: tracked 3 of 8 frames"; empty if it was all of them.
  std::string lost_tracking() const;
  bool partial() const { return run.stopped || run.error != nullptr; }
};

/// The content of summary.json: `predicted`, `measured` and `accuracy` apart from each other.
Json to_json(const RunReport& report);
/// The same for people.
std::string to_text(const RunReport& report, const Console& console);

/// trace.json: predicted and measured as separate processes, one lane per engine.
void write_run_trace(const std::string& path, const RunReport& report);

/// A picture for people: the first frame with its features, its disparities, the path driven.
/// `path` and `truth` are positions of the camera; `truth` may be empty.
void write_overview(const std::string& path, const DepthOutput& depth,
                    const frontend::FrontendResult& features, const io::Trajectory& estimate,
                    const io::Trajectory& truth);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_RUN_H
