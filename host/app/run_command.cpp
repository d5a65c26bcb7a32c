// partita run: the perception pipeline over a data set or the built-in scenario.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "devices/profile/error.h"
#include "devices/timeline/record.h"
#include "host/app/command.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/result_folder.h"
#include "host/app/run.h"
#include "host/app/run_counts.h"
#include "host/app/stop.h"
#include "host/app/wall_clock.h"
#include "host/io/json_file.h"
#include "host/io/output_folder.h"
#include "host/io/trajectory.h"

namespace partita::app {
namespace {

namespace fs = std::filesystem;

const ResultFiles& results() {
  static const ResultFiles files{
      .writer = io::kRunWriter,
      .identity = "summary.json",
      .files = {"overview.png", "trajectory.txt", "trajectory.tum", "trace.json", "work.json",
                "summary.json"},
      .folders = {"disparity"}};
  return files;
}

/// Whether `path` is `folder` or lies in it; both without symbolic links.
bool is_within(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
         folder.end();
}

/// Results in the data set's own folders would replace its truth, even with --force. Folders are
/// compared as they are on disk: a data set may be put together from symbolic links.
void refuse_dataset_folder(const fs::path& out, const fs::path& dataset) {
  const fs::path results = fs::weakly_canonical(out);
  const fs::path disparity = fs::weakly_canonical(out / "disparity");
  const fs::path whole = fs::canonical(dataset);
  bool shared = is_within(results, whole) || is_within(disparity, whole);
  for (const auto& entry : fs::directory_iterator(whole)) {
    if (!entry.is_directory()) continue;
    const fs::path part = fs::canonical(entry.path());
    shared = shared || is_within(results, part) || is_within(disparity, part) ||
             results == part.parent_path();
  }
  if (!shared) return;
  throw OutputError(fmt::format("{}: would write into the data set '{}'; choose another --out",
                                out.string(), dataset.string()));
}

/// Seconds since this process was started, dynamic linking included.
double seconds_since_start() {
  std::ifstream stat("/proc/self/stat");
  std::string text((std::istreambuf_iterator<char>(stat)), {});
  std::istringstream fields(text.substr(text.rfind(')') + 1));
  std::string field;
  for (int i = 3; i <= 22 && fields >> field; ++i) {
  }
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  const double ticks = std::strtod(field.c_str(), nullptr);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9 -
         ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

class Run {
 public:
  Run(const RunOptions& options, const Console& console) : options_(options), console_(console) {}

  int execute() {
    const bool native = options_.machine == kNativeMachine;
    const partition::Placement placement = wanted_placement();
    if (native && options_.drop_late) {
      throw UsageError(
          "run: --drop-late decides by predicted times, which --machine native has not");
    }
    if (native && (options_.allow_source || !options_.fault.empty())) {
      throw UsageError(
          "run: --allow-source and --fault are for emulated devices, which --machine native has "
          "not");
    }
    set_emulation({.machine = options_.machine,
                   .allow_source = options_.allow_source,
                   .fault = options_.fault,
                   .recording = true});
    open_source();
    if (!options_.dataset.empty()) refuse_dataset_folder(options_.out, options_.dataset);
    refuse_foreign_folder(options_.out, options_.force, results());
    // A container that the user names holds the device's own circuits.
    const bool own = options_.execute.empty() ? native || !options_.container.empty()
                                              : options_.execute == "own";
    const runtime::Execute execute = own ? runtime::Execute::own : runtime::Execute::fast;
    Pipeline pipeline(
        {options_.machine, placement, execute, options_.drop_late, options_.container},
        source_->calibration());
    const io::OutputFolder folder =
        output([&] { return io::OutputFolder(options_.out, io::kRunWriter); });
    remove_earlier_results(folder, results());
    catch_stop_signals();
    return process(pipeline, folder, placement, execute);
  }

 private:
  partition::Placement wanted_placement() const {
    const partition::Placement defaults = default_placement();
    try {
      return partition::parse_placement(options_.placement, defaults);
    } catch (const profile::Error& error) {
      throw UsageError(error.what());
    }
  }

  /// The paper's division of labour, as far as the machine has the devices: localization on an FPGA
  /// before a GPU before a CPU, the scene on a GPU before a CPU before an FPGA.
  partition::Placement default_placement() const {
    if (options_.machine == kNativeMachine) return {{"cpu", "cpu"}};
    using Type = profile::DeviceType;
    const profile::Machine machine = profile::load_machine(options_.machine, places().profiles);
    const auto first_of = [&machine](std::initializer_list<Type> wanted) -> std::string {
      for (const Type type : wanted) {
        for (const profile::MachineDevice& device : machine.devices) {
          if (device.profile.type != type) continue;
          return type == Type::fpga ? "fpga" : type == Type::gpu ? "gpu" : "cpu";
        }
      }
      return "cpu";
    };
    return {{first_of({Type::fpga, Type::gpu, Type::cpu}),
             first_of({Type::gpu, Type::cpu, Type::fpga})}};
  }

  void open_source() {
    if (options_.dataset.empty()) {
      sensing::ScenarioOptions scenario;
      scenario.seed = options_.seed;
      scenario.width = options_.width;
      scenario.height = options_.height;
      if (options_.frames > 0) scenario.frames = options_.frames;
      if (options_.rate_hz > 0) scenario.rate_hz = options_.rate_hz;
      source_ = sensing::open_scenario(scenario);
    } else {
      source_ = sensing::open_kitti(options_.dataset);
    }
    frames_ = source_->size();
    if (options_.frames > 0) frames_ = std::min(frames_, options_.frames);
    for (std::size_t k = 0; k < frames_; ++k) {
      arrivals_.push_back(
          options_.rate_hz > 0
              ? static_cast<std::uint64_t>(static_cast<double>(k) * 1e9 / options_.rate_hz)
              : static_cast<std::uint64_t>(source_->timestamp_ns(k) - source_->timestamp_ns(0)));
    }
    period_ = arrivals_.size() > 1 ? arrivals_.back() / (arrivals_.size() - 1) : 100'000'000;
  }

  int process(Pipeline& pipeline, const io::OutputFolder& folder,
              const partition::Placement& placement, runtime::Execute execute) {
    FrameFeed feed(*source_, frames_, partition::kBranches.size(),
                   options_.drop_late ? FrameFeed::Pace::quickest : FrameFeed::Pace::slowest);
    const std::uint64_t warm_start = wall_now();
    pipeline.warm_up();
    Measurement measured;
    measured.warm_up_s = static_cast<double>(wall_now() - warm_start) * 1e-9;
    measured.start_up_s = seconds_since_start();

    DepthOutput depth(output([&] { return folder.series("disparity", ".png"); }));
    ProgressBar bar(console_, "frames", frames_);
    const PipelineRun run = pipeline.run(
        feed, arrivals_,
        [&](std::shared_ptr<const sensing::Frame> frame, depth::DisparityMap map) {
          output([&] { depth.add(std::move(frame), std::move(map)); });
        },
        [&bar](std::size_t done) { bar.update(done); });
    bar.clear();
    for (const std::string& notice : source_->notices()) console_.notice(notice);

    RunReport report{.options = options_,
                     .pipeline = pipeline,
                     .source = *source_,
                     .run = run,
                     .placement = placement,
                     .execute = execute,
                     .input_hash = {},
                     .measured = measured,
                     .accuracy = {},
                     .prediction = {},
                     .files = {}};
    finish(report, feed, depth, folder);
    if (run.error) std::rethrow_exception(run.error);
    return run.stopped ? exit_interrupted : exit_ok;
  }

  /// Writes what was finished, marked as partial if it is not everything.
  void finish(RunReport& report, const FrameFeed& feed, DepthOutput& depth,
              io::OutputFolder folder) {
    const PipelineRun& run = report.run;
    if (const std::string lost = report.lost_tracking(); !lost.empty()) console_.notice(lost);
    report.frames = frames_;
    for (const BranchRun& branch : run.branches) {
      report.frames = std::min(report.frames, branch.frames.size() + branch.dropped.size());
    }
    report.input_hash = feed.hash(report.frames);
    report.rate_hz = 1e9 / static_cast<double>(std::max<std::uint64_t>(period_, 1));
    report.measured.total_s = total_seconds(run);
    try {
      report.accuracy.depth = output([&] { return depth.finish(); });
    } catch (const Error&) {
      // The disk refused a picture: that has ended the run, and is told as its reason.
      if (!run.error) throw;
    }
    if (report.frames == 0) return;
    output([&] { write_trajectories(report, folder); });
    if (report.pipeline.predicted()) report.prediction = predict(report, folder);
    report.files.insert(report.files.end(),
                        {"disparity/", "trace.json", kWorkFile, "summary.json"});
    output([&] {
      if (depth.first_map() && !run.localization.empty()) {
        write_overview(folder.file("overview.png"), depth, run.localization.front(), estimate_,
                       truth_);
        report.files.insert(report.files.begin(), "overview.png");
      }
      write_run_trace(folder.file("trace.json"), report);
      const std::vector<FrameWork> work = run.work(report.frames);
      write_counts(folder.file(kWorkFile),
                   {.origin = fmt::format("{} frames of {}", work.size(), source_->name()),
                    .width = source_->calibration().width,
                    .height = source_->calibration().height,
                    .frames = work});
      const Json summary = to_json(report);
      io::write_json(folder.file("summary.json"), summary);
      if (!report.partial()) folder.complete();
      if (!run.error) console_.result(to_text(report, console_), summary);
    });
  }

  static double total_seconds(const PipelineRun& run) {
    std::uint64_t first = UINT64_MAX, last = 0;
    for (const BranchRun& branch : run.branches) {
      for (const WallFrame& frame : branch.frames) {
        first = std::min(first, frame.start);
        last = std::max(last, frame.end);
      }
    }
    return last > first ? static_cast<double>(last - first) * 1e-9 : 0;
  }

  void write_trajectories(RunReport& report, const io::OutputFolder& folder) {
    const auto true_poses = source_->true_poses();
    std::vector<std::int64_t> times;
    for (const frontend::FrontendResult& frame : report.run.localization) {
      const auto k = static_cast<std::size_t>(frame.frame);
      if (k >= report.frames) break;
      estimate_.push_back(frame.T_world_cam);
      times.push_back(source_->timestamp_ns(k));
      if (true_poses) truth_.push_back(true_poses->at(k));
    }
    io::write_kitti_trajectory(folder.file("trajectory.txt"), estimate_);
    io::write_tum_trajectory(folder.file("trajectory.tum"), times, estimate_);
    report.files.insert(report.files.end(), {"trajectory.txt", "trajectory.tum"});
    if (!truth_.empty()) report.accuracy.trajectory = io::trajectory_error(estimate_, truth_);
  }

  /// Predicted figures come from the canonical replay of the record, which no race between this
  /// computer's threads can change.
  Prediction predict(const RunReport& report, const io::OutputFolder& folder) const {
    const std::string file = folder.file(".partita-record.jsonl");
    output([&] { report.pipeline.session(Branch::localization).extension().export_record(file); });
    Prediction prediction;
    prediction.machine = profile::load_machine(options_.machine, places().profiles);
    prediction.record = timeline::load_record(file);
    prediction.schedule = timeline::replay(prediction.record);
    std::vector<partition::Arrival> arrivals;
    for (std::size_t k = 0; k < report.frames; ++k) {
      arrivals.push_back({static_cast<std::int64_t>(k), arrivals_[k]});
    }
    prediction.summary = partition::summarise(prediction.record, prediction.schedule,
                                              prediction.machine, arrivals, period_);
    std::error_code ignored;
    fs::remove(file, ignored);
    return prediction;
  }

  const RunOptions& options_;
  const Console& console_;
  std::unique_ptr<sensing::FrameSource> source_;
  std::size_t frames_ = 0;
  std::vector<std::uint64_t> arrivals_;
  std::uint64_t period_ = 0;
  io::Trajectory estimate_, truth_;
};

void add_input_options(CLI::App* command, RunOptions& options, bool& scenario) {
  auto* dataset = command->add_option("--dataset", options.dataset,
                                      "Sequence folder in the layout of KITTI odometry");
  command->add_flag("--scenario", scenario, "The built-in street (default)")->excludes(dataset);
  command
      ->add_option("--frames", options.frames,
                   "Only the first N frames (scenario: this many, default 30)")
      ->check(CLI::Range(1, 100000));
  command->add_option("--seed", options.seed, "Of the scenario")
      ->check(seed_range())
      ->excludes(dataset)
      ->capture_default_str();
  command->add_option("--width", options.width, "Of the scenario, pixels")
      ->check(CLI::Range(64, 4096))
      ->excludes(dataset)
      ->capture_default_str();
  command->add_option("--height", options.height, "Of the scenario, pixels")
      ->check(CLI::Range(64, 4096))
      ->excludes(dataset)
      ->capture_default_str();
  command->add_option("--rate", options.rate_hz, "Frames per second (default: as recorded)")
      ->check(number_range(0.1, 10000.0));
}

}  // namespace

void add_run(CLI::App& app, Context& context) {
  CLI::App* command = add_subcommand(
      app, context, "run", "Run perception on a machine: results, predicted times, energy",
      "partita run --scenario --frames 10\n"
      "partita run --dataset KITTI/00 --placement localization=gpu,scene=gpu --out both-on-gpu\n"
      "partita run --machine tx2 --placement localization=cpu,scene=gpu\n"
      "partita run --machine native --json");
  auto options = std::make_shared<RunOptions>();
  auto scenario = std::make_shared<bool>(false);
  add_input_options(command, *options, *scenario);
  add_machine_option(command, options->machine);
  command->add_option(
      "-p,--placement", options->placement,
      "Device per task, as fpga, gpu, cpu or a part (3 characters or more) of its name (default: "
      "localization=fpga,scene=gpu as far as the machine has them)");
  command
      ->add_option("--execute", options->execute,
                   "Text that computes the results on an emulated device: own, or fast, the equal "
                   "CPU variant (default: fast; native: own)")
      ->check(CLI::IsMember({"own", "fast"}));
  command->add_option("-o,--out", options->out, "Folder for the results")->capture_default_str();
  add_container_option(command, options->container);
  command->add_flag("--force", options->force, "Write into a folder that holds foreign files");
  command->add_flag("--drop-late", options->drop_late,
                    "Skip frames whose successor has already arrived (by predicted time)");
  command->add_flag("--allow-source", options->allow_source, "Let an emulated FPGA compile source");
  command->add_option("--fault", options->fault, "Inject a fault, as in docs/emulation.md");
  command->callback([options, scenario, &context] {
    context.action = [options, &context] { return Run(*options, context.console).execute(); };
  });
}

}  // namespace partita::app
