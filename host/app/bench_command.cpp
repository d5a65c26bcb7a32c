// partita bench: what our own software costs, by itself and beside others.
#include <algorithm>
#include <fstream>
#include <sstream>
#include <thread>

#include <fmt/format.h>

#include "host/app/bench.h"
#include "host/app/child.h"
#include "host/app/command.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/overhead.h"
#include "host/app/scratch.h"

namespace partita::app {
namespace {

struct OverheadOptions {
  std::string machine = "gpu-only";
  int rounds = 7;
  bool child = false;  ///< internal: measure raw launches in this process and print them
};

void measure_in_child(const std::string& machine, std::vector<Batch>& batches) {
  std::istringstream text(run_self({"bench", "overhead", "--child", "--machine", machine}));
  for (Batch batch; text >> batch.calls >> batch.all;) batches.push_back(batch);
}

int print_raw_launches(const std::string& machine) {
  set_emulation({.machine = machine});
  for (const runtime::Device& device : runtime::find_devices()) {
    if (!device.accepts_source) continue;
    for (const Batch& batch : raw_launches(device, {})) {
      fmt::print("{:.1f} {:.1f}\n", batch.calls, batch.all);
    }
    return exit_ok;
  }
  throw DeviceError(fmt::format("bench: machine {} has no device that takes source", machine));
}

Json compared(const std::vector<Batch>& without, const std::vector<Batch>& with,
              double Batch::*figure) {
  const Quartiles a = quartiles(without, figure), b = quartiles(with, figure);
  return {{"without_ns", a.median},
          {"without_quartiles_ns", {a.low, a.high}},
          {"with_ns", b.median},
          {"with_quartiles_ns", {b.low, b.high}},
          {"added_ns", b.median - a.median},
          {"below_noise", below_noise(a, b)},
          {"ratio", b.median / a.median}};
}

Json compared(const std::vector<Batch>& without, const std::vector<Batch>& with) {
  return {{"calls", compared(without, with, &Batch::calls)},
          {"all", compared(without, with, &Batch::all)}};
}

void add_row(Table& table, const std::string& name, const Json& values) {
  table.add({name, format_ns(values["without_ns"]), format_ns(values["with_ns"]),
             format_ns(values["added_ns"]) + (values["below_noise"] ? " (below noise)" : ""),
             fmt::format("{:.2f}", values["ratio"].get<double>())});
}

int overhead(const OverheadOptions& options, const Console& console) {
  if (options.child) return print_raw_launches(options.machine);
  if (options.machine == kNativeMachine) {
    throw UsageError("bench: the overhead of the layer needs an emulated machine");
  }
  machine_file(options.machine);  // complains about it before anything is measured
  std::vector<Batch> bare, layered;
  ProgressBar bar(console, "bench overhead", static_cast<std::size_t>(options.rounds));
  for (int round = 0; round < options.rounds; ++round) {
    // In turns, so that a change of the machine's load meets both sides.
    measure_in_child(kNativeMachine, bare);
    measure_in_child(options.machine, layered);
    bar.update(static_cast<std::size_t>(round) + 1);
  }
  set_emulation({.machine = kNativeMachine});
  const runtime::Device device = runtime::find_devices().front();
  const Pair pair = raw_and_framework_launches(
      device, {.batches = 15 * static_cast<std::size_t>(options.rounds)});
  bar.clear();

  Json document;
  document["what"] = fmt::format(
      "median wall time per launch of a kernel that does nothing, in batches of {} with a "
      "clFinish; "
      "{} batches a side, in turns; noise is the interquartile range",
      Batches{}.commands, bare.size());
  document["device"] = device.name;
  document["cores"] = std::thread::hardware_concurrency();
  document["machine"] = options.machine;
  Json& measured = document["measured"];
  measured["layer"] = compared(bare, layered);
  measured["framework"] = compared(pair.raw, pair.framework);
  Table table({"measured", "without", "with", "added", "ratio"});
  add_row(table, "layer, calls of a command", measured["layer"]["calls"]);
  add_row(table, "layer, whole batch / commands", measured["layer"]["all"]);
  add_row(table, "framework, calls of a launch", measured["framework"]["calls"]);
  add_row(table, "framework, whole batch / launches", measured["framework"]["all"]);
  console.result(fmt::format("{}On {}: {}.\n", table.to_string(console.colour()), device.name,
                             document["what"].get<std::string>()),
                 document);
  return exit_ok;
}

int start(const std::string& machine, int runs, const Console& console) {
  const Scratch scratch;
  Table table({"run", "start to first frame", "of that warm-up"});
  Json list = Json::array();
  std::vector<double> later;
  ProgressBar bar(console, "bench start", static_cast<std::size_t>(runs) + 1);
  for (int i = 0; i <= runs; ++i) {
    const Json summary = Json::parse(run_self(
        {"run", "--scenario", "--frames", "1", "--machine", machine, "--out",
         scratch.path() + "/out", "--quiet", "--json"},
        {{"XDG_CACHE_HOME", scratch.path()}, {"POCL_CACHE_DIR", scratch.path() + "/pocl"}}));
    const double total = summary["measured"]["start_up_s"];
    const double warm_up = summary["measured"]["warm_up_s"];
    if (i > 0) later.push_back(total);
    const char* name = i == 0 ? "first, nothing cached" : "later";
    table.add({name, fmt::format("{:.3f} s", total), fmt::format("{:.3f} s", warm_up)});
    list.push_back({{"run", name}, {"start_up_s", total}, {"warm_up_s", warm_up}});
    bar.update(static_cast<std::size_t>(i) + 1);
  }
  bar.clear();
  Json document;
  document["machine"] = machine;
  std::nth_element(later.begin(), later.begin() + runs / 2, later.end());
  const double typical = later[static_cast<std::size_t>(runs) / 2];
  document["measured"] = {{"runs", list}, {"later_median_s", typical}};
  console.result(fmt::format("{}Median of the later runs: {:.3f} s from the process's start to the "
                             "first frame, on machine {}.\n",
                             table.to_string(console.colour()), typical, machine),
                 document);
  return exit_ok;
}

void add_overhead(CLI::App& bench, Context& context) {
  CLI::App* command = add_subcommand(
      bench, context, "overhead",
      "Time added per command by the layer, and per launch by the runtime, above raw OpenCL",
      "partita bench overhead\npartita bench overhead --rounds 15 --json");
  auto options = std::make_shared<OverheadOptions>();
  add_machine_option(command, options->machine);
  command->add_option("--rounds", options->rounds, "Pairs of processes")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--child", options->child)->group("");  // hidden
  command->callback([options, &context] {
    context.action = [options, &context] { return overhead(*options, context.console); };
  });
}

void add_start(CLI::App& bench, Context& context) {
  CLI::App* command = add_subcommand(
      bench, context, "start", "Time from the start of `partita run` to its first frame",
      "partita bench start\npartita bench start --machine native --runs 5 --json");
  auto machine = std::make_shared<std::string>("dragonfly");
  auto runs = std::make_shared<int>(3);
  add_machine_option(command, *machine);
  command->add_option("--runs", *runs, "Runs after the first, which has nothing cached")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->callback([machine, runs, &context] {
    context.action = [machine, runs, &context] { return start(*machine, *runs, context.console); };
  });
}

}  // namespace

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t value = line.find_first_not_of(" \t", line.find(':') + 1);
    return value == std::string::npos ? "" : line.substr(value);
  }
  return "";
}

void add_bench(CLI::App& app, Context& context) {
  CLI::App* command =
      add_subcommand(app, context, "bench", "Measure what Partita costs, and others beside it",
                     "partita bench overhead\npartita bench start --json\n"
                     "partita bench simulate --machine all\npartita bench peers\n"
                     "partita bench detect --model yolov3.cfg --layers");
  command->require_subcommand(1);
  add_overhead(*command, context);
  add_start(*command, context);
  add_bench_simulate(*command, context);
  add_bench_peers(*command, context);
  add_bench_detect(*command, context);
}

}  // namespace partita::app
