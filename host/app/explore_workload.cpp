// Where explore's work per frame comes from: an earlier run, a run of its own, or typical counts.
#include <filesystem>

#include <fmt/format.h>

#include "devices/profile/machine.h"
#include "host/app/child.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/explore.h"
#include "host/app/scratch.h"
#include "host/app/workload.h"
#include "host/io/json_file.h"

namespace partita::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFrames = "30";

RunCounts counts_of(const std::string& folder) {
  const std::string file = folder + "/" + kWorkFile;
  std::error_code code;
  if (!fs::exists(file, code)) {
    throw Error(fmt::format("{}: holds no {}, expected the output folder of `partita run`", folder,
                            kWorkFile));
  }
  return read_counts(file);
}

/// What a frame has to do does not depend on where it runs. So the run avoids FPGAs, which not
/// every kernel fits, and takes two devices where there are two, which is faster here.
std::string placement_for(const profile::Machine& machine) {
  bool gpu = false, cpu = false;
  for (const profile::MachineDevice& device : machine.devices) {
    gpu = gpu || device.profile.type == profile::DeviceType::gpu;
    cpu = cpu || device.profile.type == profile::DeviceType::cpu;
  }
  if (!gpu && !cpu) return "localization=fpga,scene=fpga";
  return fmt::format("localization={},scene={}", cpu ? "cpu" : "gpu", gpu ? "gpu" : "cpu");
}

RunCounts run_scenario(const ExploreReport& report, const Console& console) {
  const partition::Pipeline& pipeline = report.pipeline;
  const profile::Machine& machine = report.machines.front();
  console.notice(
      fmt::format("running {} frames of the built-in scenario on machine {} for the work per frame "
                  "(--from DIR takes an earlier run's, --no-execute typical counts)",
                  kFrames, machine.id));
  const Scratch scratch;
  std::vector<std::string> words{"run",         "--scenario",
                                 "--frames",    kFrames,
                                 "--width",     std::to_string(pipeline.width),
                                 "--height",    std::to_string(pipeline.height),
                                 "--machine",   fs::absolute(machine.path).string(),
                                 "--placement", placement_for(machine),
                                 "--execute",   "fast",
                                 "--out",       scratch.path() + "/run",
                                 "--json"};
  if (!console.progress_wanted()) words.emplace_back("--quiet");
  try {
    run_self(words);
  } catch (const ChildFailed& failed) {
    if (failed.status() == exit_interrupted) throw Interrupted();
    throw;
  }
  return counts_of(scratch.path() + "/run");
}

/// Areas that somebody has measured, in place of our estimates: {"frontend": {"lut": 177200, …}}.
void declare_areas(const std::string& file, partition::Workload& workload) {
  const Json json = io::read_json(file);
  const auto fail = [&](const std::string& what) {
    throw Error(fmt::format("{}: {}", file, what));
  };
  if (!json.is_object()) fail("expected an object of tasks");
  for (const auto& [name, values] : json.items()) {
    const auto task = std::find_if(workload.tasks.begin(), workload.tasks.end(),
                                   [&](const partition::TaskWork& t) { return t.name == name; });
    if (task == workload.tasks.end() || task->host_only) {
      fail(fmt::format("{}: no task of the pipeline that has kernels", name));
    }
    if (!values.is_object()) fail(name + ": expected an object of lut, ff, bram36, uram, dsp");
    profile::Area area;
    for (const auto& [resource, value] : values.items()) {
      std::uint64_t* const amount = resource == "lut"      ? &area.lut
                                    : resource == "ff"     ? &area.ff
                                    : resource == "bram36" ? &area.bram36
                                    : resource == "uram"   ? &area.uram
                                    : resource == "dsp"    ? &area.dsp
                                                           : nullptr;
      if (amount == nullptr) {
        fail(fmt::format("{}: unknown resource '{}', expected lut, ff, bram36, uram, dsp", name,
                         resource));
      }
      if (!value.is_number_unsigned() || value.get<std::uint64_t>() > 1'000'000'000) {
        fail(fmt::format("{}: {} is {}, expected a whole number in [0, 1e9]", name, resource,
                         value.dump()));
      }
      *amount = value.get<std::uint64_t>();
    }
    task->area = area;
    task->area_declared = true;
  }
  workload.hash = partition::content_hash(workload);
}

}  // namespace

void prepare_workload(ExploreReport& report, const Console& console,
                      const std::function<void(const partition::Pipeline&)>& check_early) {
  const ExploreOptions& options = report.options;
  report.pipeline = partition::load_pipeline(options.pipeline, places().profiles);
  if (!options.from.empty()) {
    report.counts = counts_of(options.from);
    const auto width = static_cast<std::uint32_t>(report.counts->width);
    const auto height = static_cast<std::uint32_t>(report.counts->height);
    const bool same = width == report.pipeline.width && height == report.pipeline.height;
    if (!same) partition::resize(report.pipeline, width, height);
  } else if (!options.no_execute) {
    check_early(report.pipeline);
    report.counts = run_scenario(report, console);
  }
  report.workload = report.counts ? recorded_workload(report.pipeline, *report.counts)
                                  : typical_workload(report.pipeline);
  if (!options.areas.empty()) declare_areas(options.areas, report.workload);
}

}  // namespace partita::app
