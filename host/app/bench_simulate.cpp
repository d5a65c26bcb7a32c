// partita bench simulate: how many placements of the pipeline one core of this computer simulates.
#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "devices/profile/machine.h"
#include "host/app/bench.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/wall_clock.h"
#include "host/app/workload.h"
#include "host/tasks/depth/program.h"
#include "host/tasks/frontend/program.h"
#include "partition/search/pins.h"
#include "partition/search/simulated.h"

namespace partita::app {
namespace {

using partition::TaskPlacement;

struct SimulateOptions {
  std::vector<std::string> machines{"dragonfly"};
  std::string pipeline = "dragonfly";
  std::size_t frames = 100;
  int rounds = 5;
};

/// 30 frames whose counts scatter by a fifth around the typical ones, the same in every run.
RunCounts scattered_counts(const partition::Pipeline& pipeline) {
  const int width = static_cast<int>(pipeline.width), height = static_cast<int>(pipeline.height);
  const auto frontend = frontend::typical_counts(width, height, {});
  const auto depth = depth::typical_counts(width, height, depth::default_parameters(width));
  RunCounts run{.origin = "30 frames, counts scattered by 20 %", .width = width, .height = height};
  std::uint32_t state = 1;
  for (std::int64_t k = 0; k < 30; ++k) {
    state = state * 1664525 + 1013904223;
    const double factor = 0.8 + 0.4 * static_cast<double>(state >> 16) / 65535;
    const auto scale = [factor](auto& count) {
      count = static_cast<std::remove_reference_t<decltype(count)>>(static_cast<double>(count) *
                                                                    factor);
    };
    FrameWork frame{.frame = k, .frontend = frontend, .depth = depth};
    scale(frame.frontend.keypoints_left);
    scale(frame.frontend.keypoints_right);
    scale(frame.frontend.reference);
    for (frontend::SearchCounts& search : frame.frontend.searches) {
      scale(search.searched);
      scale(search.matches);
      scale(search.hypotheses);
      scale(search.inliers);
    }
    scale(frame.depth.support_points);
    for (depth::ViewCounts& view : frame.depth.views) {
      scale(view.triangles);
      scale(view.spans);
      scale(view.covered);
      scale(view.overlaps);
      scale(view.entries);
    }
    run.frames.push_back(frame);
  }
  return run;
}

std::vector<TaskPlacement> feasible_placements(const partition::Simulator& simulator) {
  constexpr std::uint64_t kMost = 2'000;  // of a larger space, evenly spread ones
  partition::Choices all(simulator.pipeline().tasks.size());
  for (std::uint32_t t = 0; t < all.size(); ++t) {
    for (std::uint32_t p = 0; p < simulator.places(t).size(); ++p) all[t].push_back(p);
  }
  const std::uint64_t count = partition::count(all), step = count / kMost + 1;
  std::vector<TaskPlacement> placements;
  for (std::uint64_t i = 0; i < count; i += step) {
    TaskPlacement placement = partition::nth(all, i);
    if (simulator.infeasible(placement).empty()) placements.push_back(std::move(placement));
  }
  return placements;
}

using Placements = std::vector<TaskPlacement>;

/// Placements per second: median over rounds, each of as many passes over all placements as take a
/// while, after one to warm up. What a pass begins with is made by `fresh` beside the clock.
template <typename Fresh, typename Simulate>
double rate(const Placements& placements, int rounds, const Fresh& fresh,
            const Simulate& simulate) {
  constexpr double kLeastSeconds = 0.1;
  std::vector<double> rates;
  for (int round = 0; round <= rounds; ++round) {
    double seconds = 0, simulated = 0;
    while (seconds < kLeastSeconds) {
      auto simulator = fresh();
      const std::uint64_t start = wall_now();
      for (const TaskPlacement& placement : placements) simulate(simulator, placement);
      seconds += static_cast<double>(wall_now() - start) * 1e-9;
      simulated += static_cast<double>(placements.size());
    }
    if (round > 0) rates.push_back(simulated / seconds);
  }
  std::nth_element(rates.begin(), rates.begin() + rounds / 2, rates.end());
  return rates[static_cast<std::size_t>(rounds) / 2];
}

/// Of all placements those that drop nothing, and of them those whose frames are each over before
/// the next one is triggered.
struct Periodic {
  Placements complete, apart;
};
Periodic periodic(const partition::Simulator& simulator, const Placements& placements) {
  Periodic found;
  for (const TaskPlacement& placement : placements) {
    const partition::Figures figures = simulator.run(placement);
    if (figures.dropped_by_tasks > 0) continue;
    found.complete.push_back(placement);
    const bool over = std::all_of(figures.tasks.begin(), figures.tasks.end(),
                                  [&](const partition::TaskFigures& task) {
                                    return task.latency.max <= simulator.pipeline().period_ns;
                                  });
    if (over) found.apart.push_back(placement);
  }
  return found;
}

Json measure(const profile::Machine& machine, const partition::Pipeline& pipeline,
             const SimulateOptions& options) {
  const partition::Workload jitter = recorded_workload(pipeline, scattered_counts(pipeline));
  const partition::Workload typical = typical_workload(pipeline);
  const auto simulator = [&](const partition::Workload& workload, std::size_t frames) {
    partition::SimulatorOptions simulation;
    simulation.frames = frames;
    return partition::Simulator(machine, pipeline, workload, simulation);
  };
  const auto alike = [&] { return simulator(typical, options.frames); };
  const auto with_jitter = [&] { return simulator(jitter, options.frames); };
  const auto twice_as_long = [&] { return simulator(jitter, 2 * options.frames); };
  const Placements all = feasible_placements(alike());
  if (all.empty()) {
    throw Error(fmt::format("bench: no placement is feasible on machine '{}'", machine.id));
  }
  const Periodic periodic = app::periodic(alike(), all);
  const auto every = [](const partition::Simulator& s, const TaskPlacement& p) { s.run(p); };
  const auto quick = [](const partition::Simulator& s, const TaskPlacement& p) { s.quick(p); };
  const auto measured = [&](const Placements& placements, const auto& fresh, const auto& how) {
    return placements.empty() ? Json() : Json(rate(placements, options.rounds, fresh, how));
  };
  return {{"machine", machine.id},
          {"placements", all.size()},
          {"every_frame_per_s", measured(all, with_jitter, every)},
          {"jitter_per_s", measured(all, with_jitter, quick)},
          {"jitter_twice_as_long_per_s", measured(all, twice_as_long, quick)},
          {"alike_per_s", measured(all, alike, quick)},
          {"placements_complete", periodic.complete.size()},
          {"alike_complete_per_s", measured(periodic.complete, alike, quick)},
          {"placements_apart", periodic.apart.size()},
          {"alike_apart_per_s", measured(periodic.apart, alike, quick)}};
}

int simulate(const SimulateOptions& options, const Console& console) {
  std::vector<std::string> names = options.machines;
  if (std::find(names.begin(), names.end(), "all") != names.end()) {
    names = profile::list_machines(places().profiles);
  }
  const partition::Pipeline pipeline =
      partition::load_pipeline(options.pipeline, places().profiles);
  Json document;
  document["what"] = fmt::format(
      "placements of pipeline {} per second of one thread, {} frames each, median of {} rounds "
      "over all feasible ones after one to warm up. Every command: all of all frames simulated, "
      "with counts that scatter by 20 % over 30 frames. The others as the search does, each pass "
      "by a simulator that remembers nothing before it: with the same jitter, over twice the "
      "frames, without jitter (alike), of that those placements only that drop nothing "
      "(periodic), and of those the ones whose frames are each over before the next one (apart)",
      pipeline.id, options.frames, options.rounds);
  document["processor"] = processor();
  document["cores"] = std::thread::hardware_concurrency();
  Table table({"machine", "placements", "every command, 1/s", "jitter", "twice the frames", "alike",
               "periodic", "of them", "apart", "of them"});
  ProgressBar bar(console, "bench simulate", names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Json row = measure(profile::load_machine(names[i], places().profiles), pipeline, options);
    const auto shown = [&row](const char* key) {
      return row[key].is_null() ? "-" : fmt::format("{:.0f}", row[key].get<double>());
    };
    table.add(
        {row["machine"], std::to_string(row["placements"].get<std::size_t>()),
         shown("every_frame_per_s"), shown("jitter_per_s"), shown("jitter_twice_as_long_per_s"),
         shown("alike_per_s"), shown("alike_complete_per_s"),
         std::to_string(row["placements_complete"].get<std::size_t>()), shown("alike_apart_per_s"),
         std::to_string(row["placements_apart"].get<std::size_t>())});
    document["measured"].push_back(row);
    bar.update(i + 1);
  }
  bar.clear();
  console.result(
      fmt::format("{}Measured on {} ({} cores here): {}.\n", table.to_string(console.colour()),
                  document["processor"].get<std::string>(), document["cores"].get<unsigned>(),
                  document["what"].get<std::string>()),
      document);
  return exit_ok;
}

}  // namespace

void add_bench_simulate(CLI::App& bench, Context& context) {
  CLI::App* command = add_subcommand(
      bench, context, "simulate", "Placements that the partitioner simulates per second and core",
      "partita bench simulate\npartita bench simulate --machine all --rounds 3 --json");
  auto options = std::make_shared<SimulateOptions>();
  command->add_option("-m,--machine", options->machines, "Machines: names, .yaml files, or all")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--pipeline", options->pipeline, "Task graph: a name or a .yaml file")
      ->capture_default_str();
  command->add_option("--frames", options->frames, "Frames to simulate")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  command->add_option("--rounds", options->rounds, "Measurements of each figure, of 0.1 s or more")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->callback([options, &context] {
    context.action = [options, &context] { return simulate(*options, context.console); };
  });
}

}  // namespace partita::app
