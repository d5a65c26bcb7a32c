// A run's work.json, simulated without executing anything, gives the times that the run predicted:
// record and simulation come from the same pipeline by two ways.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/profile/machine.h"
#include "host/app/workload.h"
#include "partition/simulate/simulator.h"
#include "tests/app/spawn.h"
#include "tests/host/io_temp_folder.h"

namespace partita::testing {
namespace {

using nlohmann::json;

const std::string kProfiles = PARTITA_SOURCE_PROFILES;

/// A run's frame ends with its last command, a simulated task when its thread knows that: a wake-up
/// later, of which the longest on this machine is 20 us.
constexpr double kWakeUp = 20'000;

void expect_near(const partition::Distribution& simulated, const json& run, const char* what) {
  const auto expect = [what](double a, const json& b) {
    EXPECT_GE(a, b.get<double>() - 1) << what;
    EXPECT_LE(a, b.get<double>() + kWakeUp + 1) << what;
  };
  expect(simulated.mean, run["mean_ns"]);
  expect(static_cast<double>(simulated.p50), run["p50_ns"]);
  expect(static_cast<double>(simulated.p99), run["p99_ns"]);
  expect(static_cast<double>(simulated.max), run["max_ns"]);
}

std::uint32_t place_of(const partition::Simulator& simulator, std::uint32_t task,
                       const std::string& device) {
  const auto& places = simulator.places(task);
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    if (places[i].name == device) return i;
  }
  ADD_FAILURE() << "no place " << device;
  return 0;
}

TEST(Replay, OfARunsCountsGivesTheRunsTimes) {
  const std::pair<const char*, const char*> placements[] = {
      {"zcu102", "gtx1060"}, {"gtx1060", "gtx1060"}, {"i5-8500", "gtx1060"}, {"zcu102", "i5-8500"}};
  const profile::Machine machine = profile::load_machine("dragonfly", kProfiles);
  partition::Pipeline pipeline = partition::load_pipeline("perception", kProfiles);
  partition::resize(pipeline, 480, 288);
  for (const auto& [localization, scene] : placements) {
    const TempFolder folder;
    const std::string placement =
        std::string("localization=").append(localization).append(",scene=").append(scene);
    SCOPED_TRACE(placement);
    const json summary =
        partita_json({"run", "--frames", "8", "--width", "480", "--height", "288", "--placement",
                      placement, "--quiet", "--out", folder.file("out")});
    const partition::Workload workload = app::recorded_workload(pipeline, folder.file("out"));
    partition::SimulatorOptions options;
    options.frames = 8;
    const partition::Simulator simulator(machine, pipeline, workload, options);
    const partition::Figures figures =
        simulator.run({place_of(simulator, 0, localization), place_of(simulator, 1, scene)});
    const json& latency = summary["predicted"]["latency"];
    expect_near(figures.tasks[0].latency, latency["localization"], "localization");
    expect_near(figures.tasks[1].latency, latency["scene"], "scene");
    expect_near(figures.perception, latency["perception"], "perception");
  }
}

}  // namespace
}  // namespace partita::testing
