// The subcommands. Each file *_command.cpp adds one to the command line; main() runs the one
// chosen.
#ifndef PARTITA_HOST_APP_COMMAND_H
#define PARTITA_HOST_APP_COMMAND_H

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "host/app/console.h"

namespace partita::app {

struct Context {
  Console console;
  std::vector<std::string> tail;  ///< the words behind "--": another program and its arguments
  std::function<int()> action;    ///< set by the chosen subcommand; returns the exit status
};

/// A subcommand with --json and --quiet, a description and examples (lines without indentation).
CLI::App* add_subcommand(CLI::App& parent, Context& context, const std::string& name,
                         const std::string& description, const std::string& examples);

/// --machine, with the names that there are.
void add_machine_option(CLI::App* command, std::string& machine);
/// --container, for a device that takes no source and was not packaged for.
void add_container_option(CLI::App* command, std::string& container);

/// For --seed: 0 to 2^64-1. A conversion alone would wrap what is outside.
CLI::Validator seed_range();
/// For real numbers: as CLI::Range, which lets "nan" pass.
CLI::Validator number_range(double least, double most);

void add_run(CLI::App& app, Context& context);
void add_explore(CLI::App& app, Context& context);
void add_diff(CLI::App& app, Context& context);
void add_devices(CLI::App& app, Context& context);
void add_emulate(CLI::App& app, Context& context);
void add_depth(CLI::App& app, Context& context);
void add_detect(CLI::App& app, Context& context);
void add_track(CLI::App& app, Context& context);
void add_localize(CLI::App& app, Context& context);
void add_bundle_adjust(CLI::App& app, Context& context);
void add_verify(CLI::App& app, Context& context);
void add_bench(CLI::App& app, Context& context);
void add_package(CLI::App& app, Context& context);
void add_generate(CLI::App& app, Context& context);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_COMMAND_H
