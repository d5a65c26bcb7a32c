// Random pipelines and workloads for the partitioner's property tests: deterministic from a seed.
#ifndef PARTITA_TESTS_PARTITION_RANDOM_WORLD_H
#define PARTITA_TESTS_PARTITION_RANDOM_WORLD_H

#include <random>
#include <string>

#include "partition/simulate/simulator.h"

namespace partita::partition::test {

struct WorldOptions {
  std::size_t most_tasks = 6;
  std::size_t recorded_frames = 7;  ///< 1: no jitter
  bool drops = true;
  bool every = true;
};

class RandomWorld {
 public:
  explicit RandomWorld(std::uint32_t seed, const WorldOptions& options = {})
      : random_(seed), options_(options) {
    pipeline.id = "random";
    pipeline.period_ns = 2'000'000 + 1000 * pick(40'000);
    const std::size_t count = 2 + pick(options.most_tasks - 1);
    for (std::uint32_t i = 0; i < count; ++i) add_task(i);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (!read_[i]) pipeline.outputs.push_back(i);
    }
    pipeline.perception = pipeline.outputs;
    workload.origin = "random";
    check(pipeline, workload);
    check(workload);
  }

  TaskPlacement placement(const Simulator& simulator) {
    TaskPlacement placement;
    for (std::uint32_t i = 0; i < pipeline.tasks.size(); ++i) {
      placement.push_back(static_cast<std::uint32_t>(pick(simulator.places(i).size())));
    }
    return placement;
  }
  std::size_t pick(std::size_t n) { return random_() % n; }

  Pipeline pipeline;
  Workload workload;

 private:
  void add_task(std::uint32_t i) {
    PipelineTask task;
    task.name = std::string("task").append(std::to_string(i));
    task.every = options_.every && pick(3) == 0 ? 1 + static_cast<std::uint32_t>(pick(4)) : 1;
    for (std::uint32_t from = 0; from < i; ++from) {
      if (pick(3) != 0) continue;
      task.inputs.push_back({from, "out"});
      read_[from] = true;
    }
    if (task.inputs.empty()) task.sensor_bytes = 100'000;
    if (options_.drops && pick(2) == 0) {
      task.when_full = pick(2) == 0 ? WhenFull::drop_oldest : WhenFull::drop_newest;
      task.queue_depth = 1 + static_cast<std::uint32_t>(pick(3));
    }
    task.host_only = pick(5) == 0;
    read_.push_back(false);
    TaskWork work;
    work.name = task.name;
    work.host_only = task.host_only;
    work.variants = {!task.host_only, !task.host_only, !task.host_only};
    work.outputs = {{"out", pick(3) == 0 ? 0 : pick(400'000)}};
    work.area = {pick(90'000), pick(90'000), pick(300), 0, pick(900)};
    const std::size_t frames = pick(2) == 0 ? 1 : options_.recorded_frames;
    for (std::size_t k = 0; k < frames; ++k) work.frames.push_back(program(work));
    pipeline.tasks.push_back(std::move(task));
    workload.tasks.push_back(std::move(work));
  }

  Program program(TaskWork& task) {
    Program program;
    if (pick(12) == 0) return program;
    const std::size_t steps = 1 + pick(12);
    for (std::size_t s = 0; s < steps; ++s) {
      Step step;
      const std::size_t dice = task.host_only ? 9 : pick(10);
      step.kind = dice < 5   ? StepKind::kernel
                  : dice < 6 ? StepKind::write
                  : dice < 7 ? StepKind::read
                  : dice < 8 ? StepKind::copy
                  : dice < 9 ? StepKind::finish
                             : StepKind::host;
      step.bytes = pick(5) == 0 ? 0 : pick(500'000);
      step.blocking = pick(3) == 0;
      if (step.kind == StepKind::kernel || step.kind == StepKind::host) {
        step.name = task.name + (step.kind == StepKind::host ? "_step" : "_kernel");
        step.name.append(std::to_string(pick(3)));
        step.work = static_cast<std::uint32_t>(task.works.size());
        step.circuit.compute_units = pick(6) == 0 ? 2 : 1;
        task.works.push_back(works());
      }
      program.push_back(std::move(step));
    }
    return program;
  }

  VariantWork works() {
    VariantWork works;
    const std::uint64_t scale = std::uint64_t{1} << pick(8);
    for (Work& work : works) {
      work.kind = static_cast<WorkKind>(pick(kWorkKinds));
      work[OpClass::int_add] = pick(200'000) * scale;
      work[OpClass::float_fma] = pick(200'000) * scale;
      work.read_unique = work.read_issued = pick(40'000) * scale;
      work.written_unique = work.written_issued = pick(20'000) * scale;
      work.groups = 1 + pick(500);
      work.group_items = 1 + pick(256);
      work.add_loop(pick(20'000) * scale, 1, 30);
    }
    return works;
  }

  std::mt19937 random_;
  WorldOptions options_;
  std::vector<bool> read_;
};

}  // namespace partita::partition::test

#endif  // PARTITA_TESTS_PARTITION_RANDOM_WORLD_H
