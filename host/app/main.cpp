// partita: one command for each question; see `partita --help`.
#include <algorithm>
#include <csignal>
#include <exception>
#include <iterator>

#include <CL/opencl.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/layer/container.h"
#include "devices/profile/error.h"
#include "host/app/command.h"
#include "host/app/exit_code.h"
#include "host/runtime/device.h"

namespace partita::app {
namespace {

/// One line for a person, whatever an exception's text contains.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// A misspelt command gets a better answer than CLI11's.
void check_command_name(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty() || words.front().starts_with('-')) return;
  std::string known;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == words.front()) return;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", command->get_name());
  }
  throw UsageError(fmt::format("no command '{}', expected one of {}", words.front(), known));
}

int parse_and_run(int argc, char** argv, Context& context) {
  CLI::App app{
      "Partita: what should run where on an autonomous vehicle's computer. Runs the real "
      "perception\n"
      "pipeline through OpenCL on declared hardware, with real results and predicted times.",
      "partita"};
  app.set_version_flag("--version", "partita " PARTITA_VERSION);
  app.footer(std::string("Examples:\n  partita explore --machine all --no-execute\n"
                         "  partita run --scenario --frames 10\n"
                         "  partita depth left.png right.png -o disparity.png\n"
                         "  partita devices --machine tx2\n  partita emulate -- clinfo -l\n\n") +
             kExitCodeHelp);
  app.require_subcommand(1);
  add_run(app, context);
  add_explore(app, context);
  add_diff(app, context);
  add_devices(app, context);
  add_emulate(app, context);
  add_depth(app, context);
  add_detect(app, context);
  add_track(app, context);
  add_localize(app, context);
  add_bundle_adjust(app, context);
  add_verify(app, context);
  add_bench(app, context);
  add_package(app, context);
  add_generate(app, context);

  // What stands behind "--" belongs to another program; no option of ours may be looked for in it.
  std::vector<std::string> words(argv + 1, argv + argc);
  const auto dashes = std::find(words.begin(), words.end(), "--");
  if (dashes != words.end()) {
    context.tail.assign(std::next(dashes), words.end());
    words.erase(dashes, words.end());
  }
  check_command_name(app, words);
  const std::string first = words.empty() ? "" : words.front();
  std::reverse(words.begin(), words.end());  // CLI11 takes them from the back
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::string what = error.what();
    if (dynamic_cast<const CLI::ExtrasError*>(&error) !=
        nullptr) {  // whose text has them back to front
      what = fmt::format("not understood: {}", fmt::join(app.remaining(true), " "));
    }
    const std::string command = first.starts_with('-') || first.empty() ? "" : " " + first;
    throw UsageError(fmt::format("{} (see partita{} --help)", what, command));
  }
  return context.action();
}

}  // namespace
}  // namespace partita::app

int main(int argc, char** argv) {
  using namespace partita;
  app::Context context;
  // A reader that goes away (partita … | head) is no reason to die without a word.
  std::signal(SIGPIPE, SIG_IGN);
  const auto fail = [&context](const std::string& line, int status) {
    context.console.error(app::one_line(line));
    return status;
  };
  try {
    return app::parse_and_run(argc, argv, context);
  } catch (const app::Interrupted&) {
    return fail("interrupted; what was finished is marked as partial", app::exit_interrupted);
  } catch (const app::UsageError& error) {
    return fail(error.what(), app::exit_usage);
  } catch (const app::OutputError& error) {
    return fail(error.what(), app::exit_output);
  } catch (const DeviceError& error) {
    return fail(error.what(), app::exit_device);
  } catch (const Error& error) {
    return fail(error.what(), app::exit_bad_input);
  } catch (const profile::Error& error) {
    return fail(error.what(), app::exit_bad_input);
  } catch (const layer::ContainerError& error) {
    return fail(error.what(), app::exit_bad_input);
  } catch (const cl::Error& error) {
    return fail(fmt::format("{} failed ({})", error.what(), runtime::error_name(error.err())),
                app::exit_device);
  } catch (const std::exception& error) {
    return fail(fmt::format("internal error, please report: {}", error.what()), app::exit_internal);
  }
}
