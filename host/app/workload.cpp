#include "host/app/workload.h"

#include <algorithm>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "devices/model/area.h"
#include "host/runtime/error.h"
#include "host/tasks/backend/outline.h"
#include "host/tasks/depth/program.h"
#include "host/tasks/detection/program.h"
#include "host/tasks/frontend/program.h"
#include "host/tasks/fusion/outline.h"
#include "host/tasks/planning/outline.h"
#include "host/tasks/sensing/outline.h"
#include "host/tasks/tracking/program.h"

namespace partita::app {
namespace {

using partition::Step;
using partition::StepKind;
using partition::TaskWork;
using runtime::Variant;
using tasks::Sensors;
using tasks::TaskExport;

static_assert(static_cast<int>(Variant::cpu) == static_cast<int>(profile::DeviceType::cpu) &&
              static_cast<int>(Variant::gpu) == static_cast<int>(profile::DeviceType::gpu) &&
              static_cast<int>(Variant::fpga) == static_cast<int>(profile::DeviceType::fpga));
static_assert(static_cast<int>(tasks::StepKind::finish) == static_cast<int>(StepKind::finish));

std::size_t index_of(Variant variant) {
  return static_cast<std::size_t>(variant);
}

/// `run` is null for typical counts.
TaskExport export_frontend(const Sensors& sensors, const RunCounts* run) {
  const frontend::FrontendParameters parameters;
  std::vector<frontend::FrameCounts> frames;
  if (run == nullptr) {
    frames.push_back(frontend::typical_counts(sensors.width, sensors.height, parameters));
  } else {
    for (const FrameWork& frame : run->frames) frames.push_back(frame.frontend);
  }
  return frontend::export_task(sensors.width, sensors.height, parameters, frames);
}

TaskExport export_depth(const Sensors& sensors, const RunCounts* run) {
  const depth::DepthParameters parameters = depth::default_parameters(sensors.width);
  std::vector<depth::FrameCounts> frames;
  if (run == nullptr) {
    frames.push_back(depth::typical_counts(sensors.width, sensors.height, parameters));
  } else {
    for (const FrameWork& frame : run->frames) frames.push_back(frame.depth);
  }
  return depth::export_task(sensors.width, sensors.height, parameters, frames);
}

TaskExport export_tracking(const Sensors& sensors, const RunCounts*) {
  const tracking::FilterParameters parameters;
  const tracking::FrameCounts counts = tracking::typical_counts(parameters);
  return tracking::export_task(sensors.width, sensors.height, parameters, std::span(&counts, 1));
}

using Exporter = TaskExport (*)(const Sensors&, const RunCounts*);

template <TaskExport (*Outline)(const Sensors&)>
TaskExport outline(const Sensors& sensors, const RunCounts*) {
  return Outline(sensors);
}

const std::map<std::string, Exporter>& exporters() {
  static const std::map<std::string, Exporter> all{{"sensing", outline<sensing::outline>},
                                                   {"frontend", export_frontend},
                                                   {"backend", outline<backend::outline>},
                                                   {"fusion", outline<fusion::outline>},
                                                   {"depth", export_depth},
                                                   {"detection", outline<detection::export_task>},
                                                   {"tracking", export_tracking},
                                                   {"planning", outline<planning::outline>}};
  return all;
}

/// Turns one task's programs into steps, each distinct Work once.
class TaskBuilder {
 public:
  explicit TaskBuilder(const TaskExport& task) {
    work_.name = task.name;
    work_.outline = task.outline;
    work_.host_only = task.kernels.empty();
    for (const Variant variant : runtime::kVariants) {
      work_.variants[index_of(variant)] =
          !work_.host_only && std::all_of(task.kernels.begin(), task.kernels.end(),
                                          [variant](const auto* k) { return k->has(variant); });
    }
    for (const runtime::KernelSpec* kernel : task.kernels) {
      if (!kernel->has(Variant::fpga)) continue;
      work_.area = model::operator+(work_.area, model::estimate_area(kernel->design));
    }
    for (const tasks::Output& output : task.outputs) {
      work_.outputs.push_back({output.name, output.bytes});
    }
    for (const tasks::Program& program : task.frames) {
      partition::Program steps;
      for (const tasks::Step& step : program.steps()) steps.push_back(convert(step));
      work_.frames.push_back(std::move(steps));
    }
  }

  TaskWork take() { return std::move(work_); }

 private:
  Step convert(const tasks::Step& from) {
    Step step;
    step.kind = static_cast<StepKind>(from.kind);
    step.bytes = from.bytes;
    step.blocking = from.blocking;
    if (from.kernel != nullptr) {
      step.name = from.kernel->name;
      step.circuit.memory_ports = from.kernel->design.memory_ports;
      step.circuit.compute_units = from.kernel->design.compute_units;
    }
    if (from.host != nullptr) step.name = from.host->name;
    if (from.kernel != nullptr || from.host != nullptr) step.work = work_index(from);
    return step;
  }

  std::uint32_t work_index(const tasks::Step& step) {
    const auto [known, is_new] =
        works_.try_emplace({step.kernel, step.host, step.shape.to_string()},
                           static_cast<std::uint32_t>(work_.works.size()));
    if (!is_new) return known->second;
    partition::VariantWork work;
    if (step.host != nullptr) {
      work[0] = step.host->work(step.shape);
    } else {
      for (const Variant variant : step.kernel->variants) {
        work[index_of(variant)] = step.kernel->declared_work(variant, step.shape);
      }
    }
    work_.works.push_back(work);
    return known->second;
  }

  TaskWork work_;
  std::map<std::tuple<const void*, const void*, std::string>, std::uint32_t> works_;
};

partition::Workload build(const partition::Pipeline& pipeline, const RunCounts* run,
                          std::string origin) {
  const Sensors sensors{static_cast<int>(pipeline.width), static_cast<int>(pipeline.height),
                        1e9 / static_cast<double>(pipeline.period_ns),
                        static_cast<double>(pipeline.imu_hz)};
  partition::Workload workload;
  workload.origin = std::move(origin);
  for (const partition::PipelineTask& task : pipeline.tasks) {
    const auto found = exporters().find(task.name);
    if (found == exporters().end()) {
      std::string known;
      for (const auto& [name, exporter] : exporters()) known += (known.empty() ? "" : ", ") + name;
      throw Error(fmt::format("pipeline {}: no task '{}', expected one of {}", pipeline.id,
                              task.name, known));
    }
    workload.tasks.push_back(to_work(found->second(sensors, run)));
  }
  partition::check(workload);
  partition::check(pipeline, workload);
  workload.hash = partition::content_hash(workload);
  return workload;
}

}  // namespace

TaskWork to_work(const TaskExport& task) {
  return TaskBuilder(task).take();
}

partition::Workload typical_workload(const partition::Pipeline& pipeline) {
  return build(pipeline, nullptr, "typical counts");
}

partition::Workload recorded_workload(const partition::Pipeline& pipeline, const RunCounts& run) {
  if (run.width != static_cast<int>(pipeline.width) ||
      run.height != static_cast<int>(pipeline.height)) {
    throw Error(fmt::format("pipeline {}: pictures of {} x {}, expected {} x {} as the run had",
                            pipeline.id, pipeline.width, pipeline.height, run.width, run.height));
  }
  return build(pipeline, &run, run.origin);
}

partition::Workload recorded_workload(const partition::Pipeline& pipeline,
                                      const std::string& folder) {
  return recorded_workload(pipeline, read_counts(folder + "/" + kWorkFile));
}

}  // namespace partita::app
