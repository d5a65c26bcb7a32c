// partita explore: which placement of a pipeline's tasks on which machine is best, and why.
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "host/app/child.h"
#include "host/app/command.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/explore.h"
#include "host/app/result_folder.h"
#include "host/app/stop.h"
#include "host/app/wall_clock.h"
#include "host/app/workload.h"
#include "host/io/file.h"
#include "host/io/json_file.h"
#include "partition/search/simulated.h"

namespace partita::app {

bool ExploreReport::partial() const {
  return std::any_of(exploration.machines.begin(), exploration.machines.end(),
                     [](const partition::MachineResult& result) { return result.stopped; });
}

namespace {

const ResultFiles& results() {
  static const ResultFiles files{
      .writer = io::kExploreWriter,
      .identity = kExploreFile,
      .files = {kExploreFile, "explore.csv", "pareto.svg", "pareto.png", "schedule.svg",
                "schedule.png", "trace.json", kWorkFile}};
  return files;
}

/// What is malformed is a mistake on the command line; what no machine can do is one of the input.
template <typename Function>
auto usage(Function&& function) {
  try {
    return function();
  } catch (const profile::Error& error) {
    throw UsageError(error.what());
  }
}

class Explore {
 public:
  Explore(const ExploreOptions& options, const Console& console)
      : options_(options), console_(console), report_{.options = options} {}

  int execute() {
    const std::uint64_t start = wall_now();
    const partition::SearchOptions search = search_options();
    load_machines();
    refuse_unwritable_folder(options_.out);
    refuse_foreign_folder(options_.out, options_.force, results());
    try {
      prepare_workload(report_, console_, [&](const partition::Pipeline& pipeline) {
        check_pins(pipeline, search.pins);
      });
    } catch (const ChildFailed& failed) {
      return failed.status();
    }
    for (const profile::Machine& machine : report_.machines) {
      report_.evaluators.push_back(
          partition::simulated(machine, report_.pipeline, report_.workload, simulation()));
    }
    catch_stop_signals();
    find(search);
    write();
    console_.notice(
        fmt::format("answered in {:.1f} s", static_cast<double>(wall_now() - start) * 1e-9));
    return report_.partial() ? exit_interrupted : exit_ok;
  }

 private:
  partition::SearchOptions search_options() const {
    partition::SearchOptions search;
    usage([&] {
      search.objective = partition::parse_objective(options_.objective);
      for (const std::string& pin : options_.pins) search.pins.push_back(partition::parse_pin(pin));
      for (const std::string& limit : options_.limits) {
        partition::parse_limit(limit, search.limits);
      }
      partition::check(options_.vehicle);
    });
    search.vehicle = options_.vehicle;
    return search;
  }

  partition::SimulatorOptions simulation() const {
    partition::SimulatorOptions simulation;
    simulation.frames = options_.frames;
    simulation.allow_swap = options_.allow_swap;
    return simulation;
  }

  void load_machines() {
    std::vector<std::string> names = options_.machines;
    if (std::find(names.begin(), names.end(), "all") != names.end()) {
      names = profile::list_machines(places().profiles);
    }
    std::set<std::string> known;
    for (const std::string& name : names) {
      if (name == kNativeMachine) {
        throw UsageError(
            "explore: predicts declared machines; --machine native has no profile to predict from");
      }
      profile::Machine machine = profile::load_machine(name, places().profiles);
      // Their names are how results tell them apart.
      if (!known.insert(machine.id).second) {
        throw UsageError(fmt::format("explore: machine '{}' is named twice", machine.id));
      }
      report_.machines.push_back(std::move(machine));
    }
  }

  /// Typical work is enough to see that no machine can satisfy the pins.
  void check_pins(const partition::Pipeline& pipeline,
                  const std::vector<partition::Pin>& pins) const {
    const partition::Workload workload = typical_workload(pipeline);
    std::string why;
    for (const profile::Machine& machine : report_.machines) {
      try {
        partition::choices(*partition::simulated(machine, pipeline, workload, simulation()), pins);
        return;
      } catch (const partition::PinError& error) {
        why += (why.empty() ? "" : "; ") + std::string(error.what());
      }
    }
    throw partition::PinError(why);
  }

  void find(partition::SearchOptions search) {
    std::vector<const partition::Evaluator*> evaluators;
    for (const auto& evaluator : report_.evaluators) evaluators.push_back(evaluator.get());
    std::optional<ProgressBar> bar;
    std::string machine;
    search.progress = [&](const partition::Progress& progress) {
      if (progress.machine != machine) {
        machine = progress.machine;
        bar.reset();
        bar.emplace(console_, "placements of " + machine, progress.budget);
      }
      bar->update(progress.evaluated);
      return !stop_requested();
    };
    try {
      report_.exploration = partition::explore(evaluators, search);
    } catch (const profile::Error&) {
      // Stopped before anything was found: then there is no answer, and no fault of the input.
      if (stop_requested()) throw Interrupted();
      throw;
    }
    const partition::MachineResult& winner = report_.winner();
    partition::SimulatorOptions options = simulation();
    options.frames = report_.scheduled_frames = std::min(options.frames, kScheduleFrames);
    const partition::Simulator simulator(report_.machine(winner), report_.pipeline,
                                         report_.workload, options);
    report_.best = simulator.reference(winner.best->placement);
  }

  void write() {
    output([&] {
      io::OutputFolder folder(options_.out, io::kExploreWriter);
      remove_earlier_results(folder, results());
      report_.files = results().files;
      if (report_.counts) {
        write_counts(folder.file(kWorkFile), *report_.counts);
      } else {
        std::erase(report_.files, kWorkFile);
      }
      io::write_file(folder.file("explore.csv"), to_csv(report_));
      write_pareto_plot(folder.path(), report_);
      write_schedule_plot(folder.path(), report_);
      write_schedule_trace(folder.file("trace.json"), report_);
      const Json document = to_json(report_);
      io::write_json(folder.file(kExploreFile), document);
      if (!report_.partial()) folder.complete();
      console_.result(to_text(report_, console_), document);
    });
  }

  const ExploreOptions& options_;
  const Console& console_;
  ExploreReport report_;
};

void add_question(CLI::App* command, ExploreOptions& options) {
  command
      ->add_option("-m,--machine", options.machines,
                   "Machines to compare: names (dragonfly, tx2, ...), .yaml files, or all")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--objective", options.objective,
                   "What is best: latency (p99), energy (a frame), throughput, cost (price)")
      ->check(CLI::IsMember({"latency", "energy", "throughput", "cost"}))
      ->capture_default_str();
  command
      ->add_option("--pin", options.pins,
                   "TASK=DEVICE or BRANCH=DEVICE: decided already. A device as fpga, gpu, cpu, a "
                   "node or a part (3 characters or more) of its name")
      ->delimiter(',');
  command->add_option("--limit", options.limits,
                      "What nothing may exceed: power=30W, price=1500, latency=100ms, energy=2J");
  command
      ->add_option("--pipeline", options.pipeline,
                   "Task graph: a name (dragonfly, perception) or a .yaml file")
      ->capture_default_str();
  command->add_option("--frames", options.frames, "Frames to simulate")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
}

void add_work(CLI::App* command, ExploreOptions& options) {
  auto* from = command->add_option("--from", options.from,
                                   "Take the work of each frame from this folder of an earlier run "
                                   "(default: run 30 frames of the built-in scenario)");
  command
      ->add_flag("--no-execute", options.no_execute,
                 "Run nothing: typical work per frame. Needs no OpenCL")
      ->excludes(from);
  command->add_flag("--allow-swap", options.allow_swap,
                    "FPGA designs that do not fit together take turns, loaded each time");
  command->add_option(
      "--areas", options.areas,
      "JSON file of FPGA areas by task, {\"frontend\": {\"lut\": 177200}}, in place "
      "of the estimates");
}

void add_vehicle(CLI::App* command, partition::Vehicle& vehicle) {
  command->add_option("--speed", vehicle.speed_mps, "Of the vehicle, m/s")
      ->check(number_range(0.01, 1000))
      ->capture_default_str();
  command->add_option("--battery", vehicle.battery_wh, "Of the vehicle, Wh")
      ->check(number_range(0.01, 1e9))
      ->capture_default_str();
  command
      ->add_option("--base-power", vehicle.base_power_w,
                   "Of all of the vehicle but its computer, W, mean while driving")
      ->check(number_range(0.01, 1e9))
      ->capture_default_str();
}

}  // namespace

void add_explore(CLI::App& app, Context& context) {
  CLI::App* command = add_subcommand(
      app, context, "explore", "What should run where: the best placement, and why it is",
      "partita explore\n"
      "partita explore --machine all --no-execute\n"
      "partita explore --machine tx2,orin-nano --objective energy --limit latency=150ms\n"
      "partita explore --pin depth=gpu --limit power=60W --from partita-out\n"
      "partita explore --no-execute --objective cost --json");
  auto options = std::make_shared<ExploreOptions>();
  add_question(command, *options);
  add_work(command, *options);
  add_vehicle(command, options->vehicle);
  command->add_option("-o,--out", options->out, "Folder for the results")->capture_default_str();
  command->add_flag("--force", options->force, "Write into a folder that holds foreign files");
  command->callback([options, &context] {
    context.action = [options, &context] { return Explore(*options, context.console).execute(); };
  });
}

}  // namespace partita::app
