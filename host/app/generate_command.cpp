// partita generate: the built-in scenario as files, in KITTI's layout.
#include <fmt/format.h>

#include "host/app/command.h"
#include "host/app/exit_code.h"
#include "host/tasks/sensing/kitti_write.h"

namespace partita::app {
namespace {

struct GenerateOptions {
  std::string out;
  sensing::ScenarioOptions scenario;
};

int generate(const GenerateOptions& options, const Console& console) {
  const auto source = sensing::open_scenario(options.scenario);
  ProgressBar bar(console, "generating", source->size());
  sensing::write_kitti(*source, options.out,
                       [&bar](std::size_t done, std::size_t) { bar.update(done); });
  bar.clear();
  Json document;
  document["out"] = options.out;
  document["seed"] = options.scenario.seed;
  document["frames"] = options.scenario.frames;
  document["width"] = options.scenario.width;
  document["height"] = options.scenario.height;
  document["rate_hz"] = options.scenario.rate_hz;
  console.result(fmt::format("{}: {} stereo frames of {}x{}, seed {}\nRun them: partita run "
                             "--dataset {}\n",
                             options.out, options.scenario.frames, options.scenario.width,
                             options.scenario.height, options.scenario.seed, options.out),
                 document);
  return exit_ok;
}

}  // namespace

void add_generate(CLI::App& app, Context& context) {
  CLI::App* command =
      add_subcommand(app, context, "generate", "Write the built-in scenario in KITTI's layout",
                     "partita generate --out street\n"
                     "partita generate --out small --frames 5 --width 640 --height 360 --seed 7");
  auto options = std::make_shared<GenerateOptions>();
  sensing::ScenarioOptions& scenario = options->scenario;
  command->add_option("-o,--out", options->out, "Folder to write")->required();
  command->add_option("--seed", scenario.seed, "Another seed is another street")
      ->capture_default_str();
  command->add_option("--frames", scenario.frames, "Stereo frames")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--width", scenario.width, "Pixels")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str();
  command->add_option("--height", scenario.height, "Pixels")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str();
  command->add_option("--rate", scenario.rate_hz, "Frames per second")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  command->callback([options, &context] {
    context.action = [options, &context] { return generate(*options, context.console); };
  });
}

}  // namespace partita::app
