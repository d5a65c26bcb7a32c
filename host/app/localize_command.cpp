// partita localize: where the vehicle was, from pictures, inertial readings and GPS.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "host/app/command.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/localize.h"
#include "host/app/result_folder.h"
#include "host/app/stop.h"
#include "host/app/wall_clock.h"
#include "host/io/json_file.h"
#include "host/io/output_folder.h"
#include "host/io/text.h"
#include "host/runtime/session.h"
#include "host/tasks/frontend/frontend.h"
#include "host/tasks/frontend/kernels.h"
#include "host/tasks/fusion/visual_motion.h"

namespace partita::app {
namespace {

namespace fs = std::filesystem;

const ResultFiles& results() {
  static const ResultFiles files{.writer = io::kLocalizeWriter,
                                 .identity = "localization.json",
                                 .files = {"trajectory.tum", "trajectory.txt", "fixes.csv",
                                           "path.svg", "path.png", "localization.json"}};
  return files;
}

double seconds_since(std::uint64_t start) {
  return static_cast<double>(wall_now() - start) * 1e-9;
}

/// START:SECONDS, counted from the first reading.
fusion::GpsGap parse_gap(const std::string& text, std::int64_t origin_ns) {
  double values[2];
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int i = 0; i < 2; ++i) {
    const auto [rest, error] = std::from_chars(at, end, values[i]);
    const bool separated = i == 0 ? rest != end && *rest == ':' : rest == end;
    if (error != std::errc() || !separated || !(values[i] >= 0 && values[i] < 1e7)) {
      throw UsageError(fmt::format("--gps-gap '{}': expected START:SECONDS, as in 12.5:10", text));
    }
    at = rest + 1;
  }
  const auto ns = [origin_ns](double s) { return origin_ns + std::llround(s * 1e9); };
  return {ns(values[0]), ns(values[0] + values[1])};
}

class Localize {
 public:
  Localize(const LocalizeOptions& options, const Console& console)
      : options_(options), console_(console) {}

  int execute() {
    if (options_.no_imu && options_.no_vision) {
      throw UsageError("localize: --no-imu and --no-vision leave nothing to localize by");
    }
    open();
    refuse_unwritable_folder(options_.out);
    refuse_foreign_folder(options_.out, options_.force, results());
    catch_stop_signals();
    LocalizeReport report{.options = options_,
                          .dataset = dataset_,
                          .drive = {},
                          .times = {},
                          .poses = {},
                          .fused = {},
                          .vision = {},
                          .gaps = {},
                          .files = {}};
    if (dataset_.frames) see(report);
    fuse(report);
    for (const std::string& notice : notices()) console_.notice(notice);
    if (report.drive.states.empty()) {
      throw Error(
          fmt::format("{}: no beginning was found: neither a rest, nor {} moments seen by the "
                      "camera, nor fixes "
                      "of a moving vehicle",
                      name(), 8));
    }
    judge(report);
    if (options_.gap_test > 0) test_gaps(report);
    output([&] { write(report); });
    return exit_ok;
  }

 private:
  std::string name() const { return options_.dataset.empty() ? "scenario" : options_.dataset; }

  void open() {
    if (options_.dataset.empty()) {
      sensing::ScenarioOptions scenario = options_.scenario;
      if (options_.frames > 0) scenario.frames = options_.frames;
      dataset_ = sensing::open_scenario_drive(scenario);
    } else {
      dataset_ = sensing::open_dataset(options_.dataset);
    }
    sensing::SensorLog& log = dataset_.log;
    if (options_.no_gps) log.gps.clear();
    if (options_.no_vision) dataset_.frames.reset();
    if (options_.no_wheels) log.R_imu_vehicle.reset();
    if (options_.positions_only) {
      for (sensing::GpsFix& fix : log.gps) fix.speed = fix.course = std::nullopt;
    }
    if (options_.no_imu && !dataset_.frames) {
      throw UsageError("localize: --no-imu needs pictures, which this data set has not");
    }
    if (!dataset_.frames && log.imu.empty()) {
      throw Error(fmt::format("{}: neither pictures nor inertial readings", name()));
    }
    if (options_.no_imu) log.imu.clear();
    drop_readings_far_from_pictures();
    origin_ns_ = log.imu.empty() ? dataset_.frames->timestamp_ns(0) : log.imu.front().timestamp_ns;
    if (dataset_.frames) origin_ns_ = dataset_.frames->timestamp_ns(0);
    for (const std::string& gap : options_.gps_gaps) gaps_.push_back(parse_gap(gap, origin_ns_));
    if (!options_.truth.empty()) log.truth = read_truth();
  }

  /// Readings that do not overlap with the pictures cannot help them.
  void drop_readings_far_from_pictures() {
    sensing::SensorLog& log = dataset_.log;
    if (!dataset_.frames || log.imu.empty() || dataset_.frames->size() == 0) return;
    const std::int64_t first = dataset_.frames->timestamp_ns(0);
    const std::int64_t last = dataset_.frames->timestamp_ns(dataset_.frames->size() - 1);
    if (log.imu.front().timestamp_ns <= last && log.imu.back().timestamp_ns >= first) return;
    log.notices.push_back("the inertial readings are of another time than the pictures: not used");
    log.imu.clear();
  }

  std::vector<sensing::TimedPose> read_truth() const {
    std::vector<sensing::TimedPose> truth;
    const bool tum = fs::path(options_.truth).extension() != ".txt" || looks_like_tum();
    if (tum) {
      const io::TimedTrajectory read = io::read_tum_trajectory(options_.truth);
      for (std::size_t i = 0; i < read.poses.size(); ++i) {
        if (i > 0 && read.timestamps_ns[i] <= read.timestamps_ns[i - 1]) {
          throw Error(fmt::format("{}: the time of pose {} does not increase", options_.truth, i));
        }
        truth.push_back({read.timestamps_ns[i], read.poses[i] * body().inverse(), {}, {}, {}});
      }
      return truth;
    }
    const io::Trajectory poses = io::read_kitti_trajectory(options_.truth);
    if (!dataset_.frames || poses.size() < dataset_.frames->size()) {
      throw Error(
          fmt::format("{}: {} poses, expected one for each picture", options_.truth, poses.size()));
    }
    for (std::size_t i = 0; i < dataset_.frames->size(); ++i) {
      truth.push_back({dataset_.frames->timestamp_ns(i), poses[i] * body().inverse(), {}, {}, {}});
    }
    return truth;
  }

  /// Eight numbers a row are TUM's, twelve KITTI's.
  bool looks_like_tum() const {
    const io::TextFile file(options_.truth);
    return !file.rows().empty() && file.rows()[0].words.size() == 8;
  }

  /// The trajectory is the camera's where there is one.
  Eigen::Isometry3d body() const {
    return dataset_.frames ? dataset_.log.T_imu_cam : Eigen::Isometry3d::Identity();
  }

  std::size_t frames() const {
    const std::size_t all = dataset_.frames->size();
    return options_.frames > 0 ? std::min(all, options_.frames) : all;
  }

  void see(LocalizeReport& report) {
    set_emulation({.machine = kNativeMachine});
    const runtime::Device device = runtime::select_device(runtime::find_devices(), "cpu");
    const runtime::Session session(device, frontend::kernel_specs());
    frontend::Frontend frontend(session, dataset_.frames->calibration());
    frontend.warm_up();
    session.save_binaries();
    fusion::VisualTrack track(dataset_.frames->calibration(), dataset_.log.imu.empty());
    ProgressBar bar(console_, "frames", frames());
    std::uint64_t busy = 0;
    for (std::size_t i = 0; i < frames(); ++i) {
      if (stop_requested()) throw Interrupted();
      const sensing::Frame frame = dataset_.frames->frame(i);
      const std::uint64_t start = wall_now();
      track.add(frontend.process(frame.left, frame.right, static_cast<std::int64_t>(i)),
                frame.timestamp_ns);
      busy += wall_now() - start;
      bar.update(i + 1);
    }
    frames_ = track.frames();
    report.frames = frames_.size();
    report.frames_lost = track.lost();
    report.vision_seconds = static_cast<double>(busy) * 1e-9;
  }

  void fuse(LocalizeReport& report) {
    fusion::EstimatorOptions estimator = fusion::options_for(dataset_.log);
    if (options_.window > 0) estimator.window = options_.window;
    ProgressBar bar(console_, "moments", frames_.empty() ? 1000 : frames_.size());
    const std::uint64_t start = wall_now();
    report.drive = fusion::localize(dataset_.log, frames_, estimator, gaps_,
                                    [&bar](std::size_t done, std::size_t) {
                                      if (stop_requested()) throw Interrupted();
                                      bar.update(done);
                                    });
    report.fusion_seconds = seconds_since(start);
    for (const fusion::NavState& s : report.drive.states) {
      report.times.push_back(s.timestamp_ns);
      report.poses.push_back(s.T_world_imu() * body());
    }
  }

  void judge(LocalizeReport& report) const {
    if (dataset_.log.truth.empty()) return;
    report.fused = compare(report.poses, truth_at(dataset_.log.truth, report.times, body()));
    if (frames_.empty()) return;
    // Vision alone over the same moments.
    io::Trajectory alone;
    std::vector<std::int64_t> times;
    for (const fusion::VisualFrame& frame : frames_) {
      if (!std::binary_search(report.times.begin(), report.times.end(), frame.timestamp_ns)) {
        continue;
      }
      alone.push_back(frame.T_world_cam);
      times.push_back(frame.timestamp_ns);
    }
    report.vision = compare(alone, truth_at(dataset_.log.truth, times, body()));
  }

  void test_gaps(LocalizeReport& report) const {
    if (dataset_.frames) {
      throw UsageError("localize: --gap-test is for drives without pictures; add --no-vision");
    }
    fusion::EstimatorOptions estimator = fusion::options_for(dataset_.log);
    if (options_.window > 0) estimator.window = options_.window;
    ProgressBar bar(console_, "gaps", report.drive.moments);
    report.gaps = fusion::all_gaps(dataset_.log, estimator, options_.gap_test, 1,
                                   [&bar](std::size_t done, std::size_t) {
                                     if (stop_requested()) throw Interrupted();
                                     bar.update(done);
                                   });
  }

  std::vector<std::string> notices() const {
    std::vector<std::string> all = dataset_.log.notices;
    if (dataset_.frames) {
      const auto more = dataset_.frames->notices();
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  }

  void write(LocalizeReport& report) const {
    io::OutputFolder folder(options_.out, io::kLocalizeWriter);
    remove_earlier_results(folder, results());
    io::write_tum_trajectory(folder.file("trajectory.tum"), report.times, report.poses);
    report.files = {"trajectory.tum"};
    if (dataset_.frames) {
      io::Trajectory relative;
      for (const auto& pose : report.poses) relative.push_back(report.poses[0].inverse() * pose);
      io::write_kitti_trajectory(folder.file("trajectory.txt"), relative);
      report.files.emplace_back("trajectory.txt");
    }
    if (!report.drive.fixes.empty()) {
      write_fixes(folder.file("fixes.csv"), report);
      report.files.emplace_back("fixes.csv");
    }
    write_path_plot(folder.path(), report);
    report.files.insert(report.files.end(), {"path.svg", "path.png", "localization.json"});
    const Json document = to_json(report);
    io::write_json(folder.file("localization.json"), document);
    folder.complete();
    console_.result(to_text(report), document);
  }

  const LocalizeOptions& options_;
  const Console& console_;
  sensing::Dataset dataset_;
  std::int64_t origin_ns_ = 0;
  std::vector<fusion::GpsGap> gaps_;
  std::vector<fusion::VisualFrame> frames_;
};

}  // namespace

void add_localize(CLI::App& app, Context& context) {
  CLI::App* command = add_subcommand(
      app, context, "localize", "Where the vehicle was: pictures, inertial readings and GPS fused",
      "partita localize --frames 100\n"
      "partita localize --dataset KITTI/sequences/00 --truth KITTI/poses/00.txt --out 00\n"
      "partita localize --dataset V1_01_easy --out v101\n"
      "partita localize --dataset 2011_09_26_drive_0001_extract\n"
      "partita localize --dataset drive.csv --gps-gap 12:10 --gap-test 10");
  auto options = std::make_shared<LocalizeOptions>();
  options->scenario.frames = 100;
  auto* dataset = command->add_option(
      "--dataset", options->dataset,
      "EuRoC, KITTI odometry or KITTI raw folder, or CSV of a drive (default: the scenario)");
  command->add_option("-o,--out", options->out, "Folder for the results")->capture_default_str();
  command->add_option("--truth", options->truth,
                      "True trajectory, TUM's or KITTI's form (default: the data set's own)");
  command->add_flag("--force", options->force, "Write into a folder that holds foreign files");
  command->add_option("--frames", options->frames, "Only the first N frames (scenario: this many)")
      ->check(CLI::Range(2, 100000));
  command->add_option("--seed", options->scenario.seed, "Of the scenario")
      ->check(seed_range())
      ->excludes(dataset)
      ->capture_default_str();
  command->add_option("--width", options->scenario.width, "Of the scenario, pixels")
      ->check(CLI::Range(64, 4096))
      ->excludes(dataset)
      ->capture_default_str();
  command->add_option("--height", options->scenario.height, "Of the scenario, pixels")
      ->check(CLI::Range(64, 4096))
      ->excludes(dataset)
      ->capture_default_str();
  command->add_flag("--no-gps", options->no_gps, "Do without fixes");
  command->add_flag("--no-imu", options->no_imu, "Do without inertial readings: vision alone");
  command->add_flag("--no-vision", options->no_vision, "Do without pictures");
  command->add_flag("--no-wheels", options->no_wheels,
                    "No vehicle on wheels: it may move sideways, climb and lean as it likes");
  command->add_flag("--positions-only", options->positions_only,
                    "Do without the GPS's speed and course");
  command->add_option("--gps-gap", options->gps_gaps,
                      "START:SECONDS from the beginning: no fixes there (may be given again)");
  command
      ->add_option("--gap-test", options->gap_test,
                   "Cut every gap of so many seconds: how far off is the position at its end?")
      ->check(number_range(0.2, 600));
  command->add_option("--window", options->window, "States in the window")
      ->check(CLI::Range(2, 50));
  command->callback([options, &context] {
    context.action = [options, &context] { return Localize(*options, context.console).execute(); };
  });
}

}  // namespace partita::app
