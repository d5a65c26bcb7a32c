// partita bundle-adjust: a problem of Bundle Adjustment in the Large, adjusted on a device.
#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "host/app/bal_problem.h"
#include "host/app/command.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/packager.h"
#include "host/io/bal.h"
#include "host/io/file.h"
#include "host/tasks/backend/ceres_solver.h"
#include "host/tasks/backend/solver.h"

namespace partita::app {
namespace {

using backend::Part;
using backend::Summary;

/// Shares of Levenberg-Marquardt's time on a CPU that the paper gives, in per cent; of the
/// factorisation and the gain ratio it gives only what is left for both.
constexpr std::array<const char*, 5> kPaperShares{"51.00", "29.80", "-", "10.45", "-"};

struct Options {
  std::string problem, output, json_file;
  std::string solver = "partita", machine = kNativeMachine, device = "cpu", variant, container;
  std::string loss = "none";
  backend::SolverOptions solving;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
};

/// What ran where, for the heading.
struct Run {
  Summary summary;
  std::string device, precision;
  bool predicted = false;
};

Run run_on_device(backend::Problem& problem, const Options& options, const Console& console) {
  set_emulation({.machine = options.machine});
  const runtime::Device device = runtime::select_device(runtime::find_devices(), options.device);
  runtime::SessionOptions session_options;
  if (!options.variant.empty()) session_options.variant = runtime::parse_variant(options.variant);
  const runtime::Variant variant = session_options.variant.value_or(device.own_variant());
  const auto precision = backend::precision_of(variant);
  if (precision == backend::Precision::full && !device.doubles) {
    throw Error(
        fmt::format("{}: has no doubles; choose --variant fpga for single precision", device.name));
  }
  const auto specs = backend::kernels(problem.model, precision).list();
  if (!device.accepts_source) {
    session_options.container =
        container_for(device, options.machine, runtime::Execute::own, options.container, specs);
  }
  const runtime::Session session(device, specs, session_options);
  const backend::BundleAdjuster adjuster(session, problem.model);
  {
    // Kernels are compiled at their first launch; that belongs to loading them.
    backend::Problem copy = problem;
    backend::SolverOptions once = options.solving;
    once.max_iterations = 1;
    adjuster.solve(copy, once);
    session.save_binaries();
  }
  ProgressBar bar(console, "iterations", static_cast<std::size_t>(options.solving.max_iterations));
  Run run;
  run.summary = adjuster.solve(problem, options.solving, [&bar](const backend::Iteration& it) {
    bar.update(static_cast<std::size_t>(it.number));
  });
  run.device = fmt::format("{} ({} variant)", device.name, to_string(variant));
  run.precision = precision == backend::Precision::full ? "double" : "single";
  run.predicted = session.extension().present();
  return run;
}

Run run_ceres(backend::Problem& problem, const Options& options) {
  Run run;
  run.summary = backend::solve_with_ceres(problem, options.solving, options.threads);
  run.device = fmt::format("Ceres, {} threads", options.threads);
  run.precision = "double";
  return run;
}

Json parts_json(const backend::PartSeconds& seconds) {
  Json parts;
  for (const Part part : backend::kParts) {
    parts[to_string(part)] = seconds[static_cast<std::size_t>(part)];
  }
  return parts;
}

Json to_json(const Options& options, const io::BalProblem& bal, const Run& run) {
  const Summary& s = run.summary;
  Json document;
  document["problem"] = options.problem;
  document["cameras"] = bal.cameras.size();
  document["points"] = bal.points.size();
  document["observations"] = bal.observations.size();
  document["solver"] = options.solver;
  document["device"] = run.device;
  document["precision"] = run.precision;
  document["linear_solver"] = s.linear_solver;
  document["loss"] = options.loss;
  document["initial_cost"] = s.initial_cost;
  document["final_cost"] = s.final_cost;
  document["iterations"] = s.steps();
  document["converged"] = s.converged;
  document["termination"] = s.termination;
  document["total_seconds"] = s.total_seconds;
  document["setup_seconds"] = s.setup_seconds;
  document["parts"] = parts_json(s.parts);
  if (run.predicted) document["predicted_parts"] = parts_json(s.predicted);
  Json& path = document["path"] = Json::array();
  for (const backend::Iteration& it : s.iterations) {
    path.push_back({{"iteration", it.number},
                    {"cost", it.cost},
                    {"cost_change", it.cost_change},
                    {"gradient", it.gradient},
                    {"step", it.step},
                    {"gain", it.gain},
                    {"radius", it.radius},
                    {"accepted", it.accepted},
                    {"seconds", it.seconds}});
  }
  return document;
}

std::string iterations_text(const Summary& s, const Console& console) {
  Table table({"iteration", "cost", "change", "gradient", "step", "gain", "radius", "ms", ""});
  for (const backend::Iteration& it : s.iterations) {
    const auto of_a_step = [&it](double value) {
      return it.number == 0 ? "-" : fmt::format("{:.2e}", value);
    };
    table.add({std::to_string(it.number), fmt::format("{:.6e}", it.cost), of_a_step(it.cost_change),
               of_a_step(it.gradient), of_a_step(it.step), of_a_step(it.gain),
               fmt::format("{:.2e}", it.radius), fmt::format("{:.2f}", it.seconds * 1e3),
               it.number == 0 || it.accepted ? "" : "not taken"});
  }
  return table.to_string(console.colour());
}

std::string parts_text(const Run& run, bool ceres, const Console& console) {
  const backend::PartSeconds& parts = run.summary.parts;
  double sum = 0, predicted_sum = 0;
  for (const double seconds : parts) sum += seconds;
  for (const double seconds : run.summary.predicted) predicted_sum += seconds;
  std::vector<std::string> header{"part", "ms", "%", "paper %"};
  if (run.predicted) header.insert(header.end(), {"predicted ms", "predicted %"});
  Table table(header);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (ceres && parts[i] == 0) continue;
    const char* name =
        ceres && backend::kParts[i] == Part::cfs ? "SE+CFS" : to_string(backend::kParts[i]);
    std::vector<std::string> row{name, fmt::format("{:.2f}", parts[i] * 1e3),
                                 fmt::format("{:.2f}", sum > 0 ? 100 * parts[i] / sum : 0),
                                 ceres ? "-" : kPaperShares[i]};
    if (run.predicted) {
      const double seconds = run.summary.predicted[i];
      row.push_back(fmt::format("{:.3f}", seconds * 1e3));
      row.push_back(fmt::format("{:.2f}", predicted_sum > 0 ? 100 * seconds / predicted_sum : 0));
    }
    table.add(row);
  }
  return table.to_string(console.colour());
}

std::string to_text(const Options& options, const io::BalProblem& bal, const Run& run,
                    const Console& console) {
  const Summary& s = run.summary;
  std::string text = fmt::format(
      "{}: {} cameras, {} points, {} observations\non {}, {} precision, {}\n\n",
      std::filesystem::path(options.problem).filename().string(), bal.cameras.size(),
      bal.points.size(), bal.observations.size(), run.device, run.precision, s.linear_solver);
  text += iterations_text(s, console) + "\n" + parts_text(run, options.solver == "ceres", console);
  text += fmt::format(
      "\ncost {:.6e} to {:.6e} in {} iterations, {:.1f} ms ({:.1f} ms of it set-up)\n"
      "ended by: {}\n",
      s.initial_cost, s.final_cost, s.steps(), s.total_seconds * 1e3, s.setup_seconds * 1e3,
      s.termination);
  return text;
}

void tell_behind(const Options& options, const io::BalProblem& bal, const Console& console) {
  const io::Behind behind = io::find_behind(bal);
  if (behind.count == 0) return;
  const io::BalObservation& o = bal.observations[behind.first];
  const std::string others =
      behind.count == 1 ? ""
                        : fmt::format("; so do those of {} more observations", behind.count - 1);
  console.notice(fmt::format("{}:{}: point {} lies behind camera {}{}", options.problem,
                             bal.lines[behind.first], o.point, o.camera, others));
}

int adjust(Options options, const Console& console) {
  if (options.problem.empty() && !options.json_file.empty()) {
    options.problem.swap(options.json_file);  // --json PROBLEM: the word is not --json's
  }
  if (options.problem.empty()) {
    throw UsageError("PROBLEM is required (see partita bundle-adjust --help)");
  }
  options.solving.loss = backend::parse_loss(options.loss);
  const io::BalProblem bal = io::read_bal(options.problem);
  tell_behind(options, bal, console);
  backend::Problem problem = to_problem(bal);
  const Run run = options.solver == "ceres" ? run_ceres(problem, options)
                                            : run_on_device(problem, options, console);
  if (!options.output.empty()) {
    io::BalProblem result = bal;
    result.cameras = problem.cameras;
    result.points = problem.points;
    output([&] { io::write_bal(options.output, result); });
  }
  const Json document = to_json(options, bal, run);
  if (!options.json_file.empty()) {
    output([&] { io::write_file(options.json_file, document.dump(2) + "\n"); });
  }
  Console shown = console;
  shown.json = console.json && options.json_file.empty();
  shown.result(to_text(options, bal, run, console), document);
  return exit_ok;
}

}  // namespace

void add_bundle_adjust(CLI::App& app, Context& context) {
  CLI::App* command =
      add_subcommand(app, context, "bundle-adjust",
                     "Adjust a problem of Bundle Adjustment in the Large on a device",
                     "partita bundle-adjust problem-49-7776-pre.txt\n"
                     "partita bundle-adjust problem.txt -o adjusted.txt --json result.json\n"
                     "partita bundle-adjust problem.txt --solver ceres\n"
                     "partita bundle-adjust problem.txt --loss huber --loss-scale 2\n"
                     "partita bundle-adjust problem.txt --variant fpga    # single precision\n"
                     "partita bundle-adjust problem.txt --machine dragonfly --device gpu");
  auto options = std::make_shared<Options>();
  command->add_option("PROBLEM", options->problem, "File in the format of BAL");
  command->add_option("-o,--output", options->output, "Write the adjusted problem to this file");
  command->remove_option(command->get_option("--json"));
  CLI::Option* json = command
                          ->add_option("--json", options->json_file,
                                       "Result as JSON, in this file or, without a name, on stdout")
                          ->expected(0, 1)
                          ->type_name("[FILE]");
  command->add_option("--solver", options->solver, "partita, or ceres for comparison")
      ->check(CLI::IsMember({"partita", "ceres"}))
      ->capture_default_str();
  add_machine_option(command, options->machine);
  command
      ->add_option("-d,--device", options->device, "cpu, gpu, fpga or a part of the device's name")
      ->capture_default_str();
  command
      ->add_option("--variant", options->variant,
                   "Text to run instead of the device's own, where it takes source")
      ->check(CLI::IsMember({"cpu", "gpu", "fpga"}));
  add_container_option(command, options->container);
  command->add_option("--loss", options->loss, "none, huber or cauchy")
      ->check(CLI::IsMember({"none", "huber", "cauchy"}))
      ->capture_default_str();
  command
      ->add_option("--loss-scale", options->solving.loss_scale, "Where the loss bends, in pixels")
      ->check(number_range(1e-6, 1e6))
      ->capture_default_str();
  command->add_option("--iterations", options->solving.max_iterations, "At most so many")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  command
      ->add_option("--function-tolerance", options->solving.function_tolerance,
                   "Ends when the cost changes by less than this share")
      ->check(number_range(0, 1))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Threads of --solver ceres")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->callback([options, json, &context] {
    context.action = [options, json, &context] {
      context.console.json = json->count() > 0;
      return adjust(*options, context.console);
    };
  });
}

}  // namespace partita::app
