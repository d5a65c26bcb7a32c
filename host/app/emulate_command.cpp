// partita emulate: any OpenCL program on an emulated machine.
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "devices/timeline/record.h"
#include "devices/timeline/schedule.h"
#include "host/app/command.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"

namespace partita::app {
namespace {

constexpr int kNotFound = 127;  ///< what shells return for a command that does not exist

struct EmulateOptions {
  EmulationOptions emulation;
  bool report = false;
};

[[noreturn]] void execute(const std::vector<std::string>& words) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  execvp(argv[0], argv.data());
  fmt::print(stderr, "partita: {}: {}\n", words[0], std::strerror(errno));
  _exit(kNotFound);
}

/// Runs the program as a child; its exit status as a shell would give it.
int spawn_and_wait(const std::vector<std::string>& words) {
  const pid_t child = fork();
  if (child < 0) throw Error(fmt::format("cannot start {}: {}", words[0], std::strerror(errno)));
  if (child == 0) execute(words);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

struct KernelRow {
  std::uint64_t calls = 0, total_ns = 0;
  bool kernel = false, estimated = false;
};

/// Predicted time on the device per command name, from the canonical replay of the record.
void report(const std::string& record_file, const Console& console) {
  const timeline::Record record = timeline::load_record(record_file);
  const timeline::Schedule schedule = timeline::replay(record);
  std::map<std::pair<std::string, std::string>, KernelRow> rows;
  for (const timeline::ScheduledCommand& scheduled : schedule.commands) {
    const timeline::RecordedCommand& command = record.commands[scheduled.command];
    if (command.queue == timeline::kNone || !scheduled.resolved) continue;
    const std::string& device = record.layout.devices[record.queues[command.queue].device].name;
    std::string name = record.names[command.name];
    if (name.empty()) name = fmt::format("({})", timeline::to_string(command.kind));
    KernelRow& row = rows[{device, name}];
    ++row.calls;
    row.kernel |= command.kind == timeline::CommandKind::kernel;
    row.total_ns += scheduled.times.end - scheduled.times.start;
    row.estimated |= command.work != timeline::kNone && record.works[command.work].estimated != 0;
  }
  std::vector<std::pair<std::pair<std::string, std::string>, KernelRow>> sorted(rows.begin(),
                                                                                rows.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return a.second.total_ns > b.second.total_ns;
  });
  Table table({"device", "command", "calls", "predicted total", "predicted mean", "work"});
  Json list = Json::array();
  for (const auto& [key, row] : sorted) {
    table.add({key.first, key.second, std::to_string(row.calls),
               format_ns(static_cast<double>(row.total_ns)),
               format_ns(static_cast<double>(row.total_ns) / static_cast<double>(row.calls)),
               !row.kernel     ? "-"
               : row.estimated ? "estimated"
                               : "declared"});
    list.push_back({{"device", key.first},
                    {"command", key.second},
                    {"calls", row.calls},
                    {"predicted_total_ns", row.total_ns},
                    {"estimated", row.estimated}});
  }
  // On stderr: stdout belongs to the program that was run.
  if (console.json) {
    const Json document{{"machine", record.layout.machine},
                        {"predicted", {{"makespan_ns", schedule.makespan}, {"commands", list}}}};
    fmt::print(stderr, "{}\n", document.dump(2));
  } else {
    fmt::print(stderr, "\nPredicted on {}: {} in all\n{}", record.layout.machine,
               format_ns(static_cast<double>(schedule.makespan)), table.to_string(false));
    if (record.racing()) {
      console.notice(
          "several threads enqueued: the times the program saw depended on their race; "
          "these are the replayed ones");
    }
  }
}

int emulate(EmulateOptions options, const Context& context) {
  if (context.tail.empty()) {
    throw UsageError("emulate: no command; write it behind --, as in: partita emulate -- clinfo");
  }
  if (!options.report) {
    set_emulation(options.emulation);
    execute(context.tail);
  }
  if (options.emulation.machine == kNativeMachine) {
    throw UsageError("emulate: --report has nothing to say about --machine native");
  }
  std::string folder = (std::filesystem::temp_directory_path() / "partita-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw OutputError(fmt::format("{}: {}", folder, std::strerror(errno)));
  }
  options.emulation.record = folder + "/record.jsonl";
  set_emulation(options.emulation);
  const int status = spawn_and_wait(context.tail);
  const bool recorded = std::filesystem::exists(options.emulation.record);
  if (recorded) report(options.emulation.record, context.console);
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  if (!recorded) context.console.notice("the program made no OpenCL call: nothing to report");
  return status;
}

}  // namespace

void add_emulate(CLI::App& app, Context& context) {
  CLI::App* command = add_subcommand(
      app, context, "emulate",
      "Run any OpenCL program on an emulated machine: partita emulate [OPTIONS] -- COMMAND...",
      "partita emulate -- clinfo -l\n"
      "partita emulate --machine gpu-only --report -- clpeak --use-event-timer\n"
      "partita emulate --allow-source -- python3 my_pyopencl_script.py");
  auto options = std::make_shared<EmulateOptions>();
  add_machine_option(command, options->emulation.machine);
  command->add_flag("--allow-source", options->emulation.allow_source,
                    "Let an emulated FPGA compile source: no real card does, for what-if runs");
  command->add_option("--fault", options->emulation.fault,
                      "Inject a fault, as in docs/emulation.md");
  command->add_flag(
      "--report", options->report,
      "Predicted time per kernel when the program has ended; the table, or the JSON with "
      "--json, goes to stderr: stdout is the command's");
  command->callback([options, &context] {
    context.action = [options, &context] { return emulate(*options, context); };
  });
}

}  // namespace partita::app
