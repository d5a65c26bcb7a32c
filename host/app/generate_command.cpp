// partita generate: the built-in scenario as files, in KITTI's layout.
#include <filesystem>

#include <fmt/format.h>

#include "host/app/command.h"
#include "host/app/exit_code.h"
#include "host/app/stop.h"
#include "host/io/output_folder.h"
#include "host/tasks/sensing/kitti_write.h"

namespace partita::app {
namespace {

struct GenerateOptions {
  std::string out;
  bool force = false;
  sensing::ScenarioOptions scenario;
};

int generate(const GenerateOptions& options, const Console& console) {
  std::error_code code;
  const bool occupied = std::filesystem::is_directory(options.out, code) &&
                        !std::filesystem::is_empty(options.out, code);
  if (occupied && !io::is_partial(options.out, io::kGenerateWriter) && !options.force) {
    throw OutputError(
        fmt::format("{}: is not empty; choose another --out or add --force", options.out));
  }
  const auto source = sensing::open_scenario(options.scenario);
  ProgressBar bar(console, "generating", source->size());
  catch_stop_signals();
  output([&] {
    sensing::write_kitti(*source, options.out, [&bar](std::size_t done, std::size_t) {
      bar.update(done);
      if (stop_requested()) throw Interrupted();
    });
  });
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
  command->add_flag("--force", options->force, "Write into a folder that is not empty");
  command->add_option("--seed", scenario.seed, "Another seed is another street")
      ->check(seed_range())
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
      ->check(number_range(0.1, 1000.0))
      ->capture_default_str();
  command->callback([options, &context] {
    context.action = [options, &context] { return generate(*options, context.console); };
  });
}

}  // namespace partita::app
