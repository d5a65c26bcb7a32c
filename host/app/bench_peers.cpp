// partita bench peers: our tasks beside the libraries that do the same, in the same run.
#include "host/app/bench_peers.h"

#include <algorithm>
#include <array>
#include <thread>

#include <fmt/format.h>

#include "host/app/bench.h"
#include "host/app/exit_code.h"
#include "host/app/stereo_pair.h"
#include "host/app/wall_clock.h"

namespace partita::app {
namespace {

struct Task {
  const char* name;
  PeerComparison (*compare)(const PeerOptions&, const RoundDone&);
  std::string PeerOptions::*needs = nullptr;  ///< an input that has no default
  const char* option = "";                    ///< which gives it
};

constexpr const char* kNetworks = "--networks with a folder as PARTITA_DATA/detect is";
constexpr const char* kProblem = "--problem with a file as those in PARTITA_DATA/bal";

constexpr std::array kTasks{
    Task{"features", compare_features},
    Task{"depth", compare_depth},
    Task{"street", compare_street},
    Task{"yolo-fastest", compare_yolo_fastest, &PeerOptions::networks, kNetworks},
    Task{"yolo-fastest-xl", compare_yolo_fastest_xl, &PeerOptions::networks, kNetworks},
    Task{"yolov3-tiny", compare_yolov3_tiny, &PeerOptions::networks, kNetworks},
    Task{"yolov3", compare_yolov3, &PeerOptions::networks, kNetworks},
    Task{"bundle-adjustment", compare_bundle_adjustment, &PeerOptions::problem, kProblem}};

struct PeersOptions {
  std::vector<std::string> tasks;  ///< empty: all
  std::vector<std::string> pair;
  PeerOptions common;
};

struct Spread {
  double low = 0, median = 0, high = 0;  ///< quartiles by nearest rank
};

Spread spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
  };
  return {at(0.25), at(0.5), at(0.75)};
}

Json to_json(const Contestant& contestant) {
  const Spread time = spread(contestant.ms);
  Json json{{"name", contestant.name},
            {"parameters", contestant.parameters},
            {"median_ms", time.median},
            {"quartiles_ms", {time.low, time.high}},
            {"rounds_ms", contestant.ms}};
  if (!contestant.quality.is_null()) json["quality"] = contestant.quality;
  return json;
}

/// How many times as long the peer takes.
double ratio(const PeerComparison& comparison, const Contestant& peer) {
  return spread(peer.ms).median / spread(comparison.ours.ms).median;
}

Json to_json(const PeerComparison& comparison) {
  Json json{{"task", comparison.task},
            {"input", comparison.input},
            {"timed", comparison.timed},
            {"ours", to_json(comparison.ours)}};
  for (const Contestant& peer : comparison.peers) {
    json["peers"].push_back(to_json(peer));
    json["peers"].back()["ratio"] = ratio(comparison, peer);
  }
  return json;
}

void add_rows(Table& table, const PeerComparison& comparison) {
  const auto add = [&](const Contestant& contestant, const std::string& times) {
    const Spread time = spread(contestant.ms);
    table.add({comparison.task, contestant.name, fmt::format("{:.2f}", time.median),
               fmt::format("{:.2f}..{:.2f}", time.low, time.high), times, contestant.quality_text});
  };
  add(comparison.ours, "1");
  for (const Contestant& peer : comparison.peers) {
    add(peer, fmt::format("{:.2f}", ratio(comparison, peer)));
  }
}

std::string details(const PeerComparison& comparison) {
  std::string text =
      fmt::format("{}: {}; timed: {}\n", comparison.task, comparison.input, comparison.timed);
  text += fmt::format("  {}: {}\n", comparison.ours.name, comparison.ours.parameters);
  for (const Contestant& peer : comparison.peers) {
    text += fmt::format("  {}: {}\n", peer.name, peer.parameters);
  }
  return text;
}

int peers(PeersOptions options, const Console& console) {
  if (!options.pair.empty()) {
    options.common.left = options.pair[0];
    options.common.right = options.pair[1];
  }
  options.common.cores = std::max(1U, std::thread::hardware_concurrency());
  Json document;
  document["what"] = fmt::format(
      "median wall time of {} rounds after one to warm up, all contestants in turns, up to {} "
      "threads each; times ours: how many times as long it takes",
      options.common.rounds, options.common.cores);
  document["processor"] = processor();
  document["cores"] = options.common.cores;
  Table table({"task", "contestant", "median ms", "quartiles", "times ours", "quality"});
  std::string below;
  for (const Task& task : kTasks) {
    const auto& wanted = options.tasks;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), task.name) == wanted.end()) {
      continue;
    }
    if (task.needs != nullptr && (options.common.*task.needs).empty()) {
      const std::string line = fmt::format("{}: needs {}", task.name, task.option);
      if (!wanted.empty()) throw UsageError("bench: " + line);
      console.notice(line + "; skipped");
      continue;
    }
    ProgressBar bar(console, fmt::format("bench peers, {}", task.name),
                    static_cast<std::size_t>(options.common.rounds));
    std::size_t done = 0;
    const PeerComparison comparison = task.compare(options.common, [&] { bar.update(++done); });
    bar.clear();
    add_rows(table, comparison);
    below += details(comparison);
    document["measured"].push_back(to_json(comparison));
  }
  console.result(
      fmt::format("{}{}Measured on {}: {}.\n", table.to_string(console.colour()), below,
                  document["processor"].get<std::string>(), document["what"].get<std::string>()),
      document);
  return exit_ok;
}

}  // namespace

std::vector<std::vector<double>> time_in_turns(std::span<const std::function<void()>> contestants,
                                               int rounds, const RoundDone& done) {
  std::vector<std::vector<double>> ms(contestants.size());
  for (const auto& contestant : contestants) contestant();
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < contestants.size(); ++i) {
      const std::uint64_t start = wall_now();
      contestants[i]();
      ms[i].push_back(static_cast<double>(wall_now() - start) * 1e-6);
    }
    done();
  }
  return ms;
}

PeerPair peer_pair(const PeerOptions& options) {
  PeerPair result;
  if (!options.left.empty()) {
    StereoPair pair = read_pair(options.left, options.right);
    result.left = std::move(pair.left);
    result.right = std::move(pair.right);
    result.name = fmt::format("{} and {}", options.left, options.right);
  } else {
    const auto scenario = sensing::open_scenario({});
    sensing::Frame frame = scenario->frame(0);
    result.name = "first frame of " + scenario->name();
    result.left = std::move(frame.left);
    result.right = std::move(frame.right);
    result.truth = std::move(frame.disparity);
  }
  result.name += fmt::format(", {}x{}", result.left.width, result.left.height);
  return result;
}

void add_bench_peers(CLI::App& bench, Context& context) {
  CLI::App* command = add_subcommand(
      bench, context, "peers", "Our tasks beside the libraries that do the same, in the same run",
      "partita bench peers\npartita bench peers --task depth --rounds 31 --json\n"
      "partita bench peers --pair left.png right.png");
  auto options = std::make_shared<PeersOptions>();
  std::vector<std::string> names;
  for (const Task& task : kTasks) names.emplace_back(task.name);
  command->add_option("--task", options->tasks, "Only these tasks, by commas")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  command
      ->add_option("--pair", options->pair,
                   "Stereo pair for depth and features (default: the scenario's first)")
      ->expected(2);
  command
      ->add_option("--networks", options->common.networks,
                   "Folder of Darknet networks for detection, as PARTITA_DATA/detect is")
      ->check(CLI::ExistingDirectory);
  command
      ->add_option("--problem", options->common.problem,
                   "Bundle adjustment to solve: a file of Bundle Adjustment in the Large")
      ->check(CLI::ExistingFile);
  command->add_option("--rounds", options->common.rounds, "Measurements of each")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->callback([options, &context] {
    context.action = [options, &context] { return peers(*options, context.console); };
  });
}

}  // namespace partita::app
