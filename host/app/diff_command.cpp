// partita diff: two runs or two explorations, side by side.
#include <cmath>

#include <fmt/format.h>

#include "host/app/command.h"
#include "host/app/diff.h"
#include "host/app/exit_code.h"

namespace partita::app {
namespace {

std::string shown(const Json& value, const std::string& unit) {
  if (value.is_null()) return "-";
  const double number = value.get<double>();
  if (unit == "ns") return fmt::format("{:.3f} ms", number / 1e6);
  const bool whole = number == std::floor(number) && std::abs(number) < 1e9;
  return fmt::format("{}{}{}",
                     whole ? fmt::format("{:.0f}", number) : fmt::format("{:.4g}", number),
                     unit.empty() ? "" : " ", unit);
}

std::string difference(const Json& figure) {
  if (figure["a"] == figure["b"]) return "=";
  const Json& percent = figure["difference_percent"];
  return percent.is_null() ? "" : fmt::format("{:+.2f} %", percent.get<double>());
}

/// Rows of what differs, or that nothing does.
std::string differences(const std::string& what, const Json& list, const Console& console) {
  if (list.empty()) return fmt::format("{}: no difference\n", what);
  Table table({what, "A", "B"});
  for (const Json& item : list) table.add({item["what"], item["a"], item["b"]});
  return table.to_string(console.colour());
}

std::string to_text(const Json& document, const Console& console) {
  std::string text;
  for (const char* side : {"a", "b"}) {
    const Json& result = document[side];
    text += fmt::format("{}  {} of {}{}\n", side[0] == 'a' ? "A" : "B",
                        document["kind"].get<std::string>(), result["file"].get<std::string>(),
                        result["partial"].get<bool>() ? " (partial)" : "");
  }
  text += "\n" + differences("inputs", document["inputs"], console);
  text += "\n" + differences("placement", document["placement"], console) + "\n";
  std::string section;
  Table table({"figure", "A", "B", "B against A"});
  const auto flush = [&] {
    if (!table.empty()) text += table.to_string(console.colour()) + "\n";
  };
  for (const Json& figure : document["figures"]) {
    if (figure["section"] != section) {
      flush();
      section = figure["section"];
      const bool predicted = document["kind"] == "exploration";
      table = Table({section + (predicted ? " (predicted)" : ""), "A", "B", "B against A"});
    }
    table.add({figure["figure"], shown(figure["a"], figure["unit"]),
               shown(figure["b"], figure["unit"]), difference(figure)});
  }
  flush();
  if (document["figures"].empty()) text += "no figure in common\n\n";
  text.pop_back();
  return text;
}

int diff(const std::string& a, const std::string& b, const Console& console) {
  const Json document = compare(load_result(a), load_result(b));
  console.result(to_text(document, console), document);
  return exit_ok;
}

}  // namespace

void add_diff(CLI::App& app, Context& context) {
  CLI::App* command =
      add_subcommand(app, context, "diff", "Two runs or two explorations, side by side",
                     "partita diff both-on-gpu partita-out\n"
                     "partita diff before/explore.json after/explore.json --json");
  auto paths = std::make_shared<std::pair<std::string, std::string>>();
  command->add_option("A", paths->first, "Output folder, or its summary.json or explore.json")
      ->required();
  command->add_option("B", paths->second, "The same")->required();
  command->callback([paths, &context] {
    context.action = [paths, &context] {
      return diff(paths->first, paths->second, context.console);
    };
  });
}

}  // namespace partita::app
