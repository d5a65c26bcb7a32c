// partita bench: what our own software costs.
#include <array>
#include <cstdio>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>

#include "host/app/command.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/overhead.h"

namespace partita::app {
namespace {

struct Options {
  std::string machine = "gpu-only";
  int rounds = 7;
  bool child = false;  ///< internal: measure raw launches in this process and print them
};

/// The layer has to be there from a process's start, so each side is measured in a child of its
/// own.
std::vector<double> measure_in_child(const std::string& machine) {
  std::array<int, 2> pipe_ends{};
  if (pipe(pipe_ends.data()) != 0) throw Error("bench: no pipe to be had");
  const pid_t child = fork();
  if (child < 0) throw Error("bench: no process to be had");
  if (child == 0) {
    dup2(pipe_ends[1], STDOUT_FILENO);
    close(pipe_ends[0]);
    execl("/proc/self/exe", "partita", "bench", "overhead", "--child", "--machine", machine.c_str(),
          static_cast<char*>(nullptr));
    _exit(127);
  }
  close(pipe_ends[1]);
  std::FILE* in = fdopen(pipe_ends[0], "r");
  std::vector<double> values;
  for (double value = 0; std::fscanf(in, "%lf", &value) == 1;) values.push_back(value);
  std::fclose(in);
  int status = 0;
  waitpid(child, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || values.empty()) {
    throw DeviceError(fmt::format("bench: the measurement on machine {} failed", machine));
  }
  return values;
}

int print_raw(const Options& options) {
  set_emulation({.machine = options.machine});
  for (const runtime::Device& device : runtime::find_devices()) {
    if (!device.accepts_source) continue;
    for (const double ns : raw_launches(device, {})) fmt::print("{:.1f}\n", ns);
    return exit_ok;
  }
  throw DeviceError(
      fmt::format("bench: machine {} has no device that takes source", options.machine));
}

int overhead(const Options& options, const Console& console) {
  if (options.child) return print_raw(options);
  if (options.machine == kNativeMachine) {
    throw UsageError("bench: the overhead of the layer needs an emulated machine");
  }
  machine_file(options.machine);  // complains about it before anything is measured
  std::vector<double> bare, layered;
  ProgressBar bar(console, "bench overhead", static_cast<std::size_t>(options.rounds));
  for (int round = 0; round < options.rounds; ++round) {
    // In turns, so that a change of the machine's load meets both sides.
    for (const double ns : measure_in_child(kNativeMachine)) bare.push_back(ns);
    for (const double ns : measure_in_child(options.machine)) layered.push_back(ns);
    bar.update(static_cast<std::size_t>(round) + 1);
  }
  set_emulation({.machine = kNativeMachine});
  const runtime::Device device = runtime::find_devices().front();
  const Pair pair = raw_and_framework_launches(
      device, {.batches = 15 * static_cast<std::size_t>(options.rounds)});
  bar.clear();

  const double bare_ns = median(bare), layered_ns = median(layered);
  const double raw_ns = median(pair.raw), framework_ns = median(pair.framework);
  const Batches size;
  Json document;
  document["what"] = fmt::format(
      "median wall time per launch of a kernel that does nothing, in batches of {} with a "
      "clFinish; "
      "{} batches a side, in turns",
      size.commands, bare.size());
  document["device"] = device.name;
  document["cores"] = std::thread::hardware_concurrency();
  document["measured"]["layer"] = {{"machine", options.machine},
                                   {"without_ns", bare_ns},
                                   {"with_ns", layered_ns},
                                   {"added_ns", layered_ns - bare_ns},
                                   {"ratio", layered_ns / bare_ns}};
  document["measured"]["framework"] = {{"raw_ns", raw_ns},
                                       {"framework_ns", framework_ns},
                                       {"added_ns", framework_ns - raw_ns},
                                       {"ratio", framework_ns / raw_ns}};
  Table table({"measured", "without", "with", "added", "ratio"});
  const auto row = [&table](const std::string& name, double without, double with) {
    table.add({name, format_ns(without), format_ns(with), format_ns(with - without),
               fmt::format("{:.2f}", with / without)});
  };
  row("layer, per command", bare_ns, layered_ns);
  row("framework, per launch", raw_ns, framework_ns);
  console.result(fmt::format("{}On {}: {}.\n", table.to_string(console.colour()), device.name,
                             document["what"].get<std::string>()),
                 document);
  return exit_ok;
}

}  // namespace

void add_bench(CLI::App& app, Context& context) {
  CLI::App* command = add_subcommand(app, context, "bench", "Measure what Partita itself costs",
                                     "partita bench overhead\npartita bench overhead --json");
  command->require_subcommand(1);
  CLI::App* overhead_command = add_subcommand(
      *command, context, "overhead",
      "Time added per command by the layer, and per launch by the runtime, above raw OpenCL",
      "partita bench overhead\npartita bench overhead --rounds 15 --json");
  auto options = std::make_shared<Options>();
  add_machine_option(overhead_command, options->machine);
  overhead_command->add_option("--rounds", options->rounds, "Pairs of processes")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  overhead_command->add_flag("--child", options->child)->group("");  // hidden
  overhead_command->callback([options, &context] {
    context.action = [options, &context] { return overhead(*options, context.console); };
  });
}

}  // namespace partita::app
