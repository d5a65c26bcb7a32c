#include "host/app/command.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace partita::app {

CLI::App* add_subcommand(CLI::App& parent, Context& context, const std::string& name,
                         const std::string& description, const std::string& examples) {
  CLI::App* command = parent.add_subcommand(name, description);
  command->add_flag("--json", context.console.json, "Result as JSON on stdout");
  command->add_flag("-q,--quiet", context.console.quiet, "No notices, no progress on stderr");
  std::string footer = "Examples:\n";
  std::size_t begin = 0;
  while (begin < examples.size()) {
    const std::size_t end = std::min(examples.find('\n', begin), examples.size());
    footer += "  " + examples.substr(begin, end - begin) + "\n";
    begin = end + 1;
  }
  command->footer(footer);
  return command;
}

void add_machine_option(CLI::App* command, std::string& machine) {
  command
      ->add_option("-m,--machine", machine,
                   "Machine to emulate: a name (dragonfly, gpu-only, cpu-only, tx2, ...), a .yaml "
                   "file, or native for the real devices")
      ->capture_default_str();
}

void add_container_option(CLI::App* command, std::string& container) {
  command->add_option("--container", container,
                      "Kernels of a device that takes no source (on a Xilinx card an xclbin); "
                      "default: packaged for the emulated one");
}

CLI::Validator seed_range() {
  const auto check = [](const std::string& text) -> std::string {
    std::uint64_t seed = 0;
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, seed);
    if (error == std::errc() && rest == end) return {};
    return "'" + text + "' is not a whole number from 0 to 2^64-1";
  };
  return {check, "0 - 2^64-1"};
}

CLI::Validator number_range(double least, double most) {
  const CLI::Validator range = CLI::Range(least, most);
  const auto check = [range](const std::string& text) -> std::string {
    double rate = 0;
    if (CLI::detail::lexical_cast(text, rate) && std::isnan(rate)) {
      return "'" + text + "' is not a number";
    }
    return range(text);
  };
  return {check, range.get_description()};
}

}  // namespace partita::app
