// An Evaluator without a simulator, for the search's tests: places and durations are drawn from a
// seed, devices serve one task at a time in the pipeline's order, nothing else costs anything. So
// every figure follows from a few lines, and the search can be held against all placements.
#ifndef PARTITA_TESTS_PARTITION_SYNTHETIC_H
#define PARTITA_TESTS_PARTITION_SYNTHETIC_H

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <string>

#include "devices/model/area.h"
#include "partition/search/evaluator.h"

namespace partita::partition::test {

/// One node with a CPU, an FPGA and `gpus` GPUs; all have valid numbers.
inline profile::Machine small_machine(std::size_t gpus = 1) {
  profile::Machine machine;
  machine.id = "synthetic";
  const auto profile = [](const std::string& id, profile::DeviceType type, double price) {
    profile::DeviceProfile p;
    p.id = id;
    p.name = "Synthetic " + id;
    p.type = type;
    p.power = {.idle_w = price / 100, .busy_w = price / 10};
    p.price_usd = price;
    p.performance.units = 4;
    return p;
  };
  machine.nodes = {{"pc", profile("host", profile::DeviceType::cpu, 100)}};
  machine.devices.push_back(
      {"fabric", profile("fabric", profile::DeviceType::fpga, 300), 0, false});
  machine.devices[0].profile.fabric.area = {1000, 1000, 100, 10, 100};
  for (std::size_t g = 0; g < gpus; ++g) {
    const std::string id = std::string("card").append(std::to_string(g));
    machine.devices.push_back(
        {id, profile(id, profile::DeviceType::gpu, 200 + 50 * static_cast<double>(g)), 0, false});
  }
  machine.devices.push_back({"host", machine.nodes[0].host, 0, true});
  return machine;
}

class Synthetic : public Evaluator {
 public:
  Synthetic(profile::Machine on, std::size_t tasks, std::uint32_t seed)
      : machine_(std::move(on)), random_(seed) {
    pipeline_.id = "synthetic";
    pipeline_.period_ns = 1'000 + pick(20'000);
    for (const auto& device : machine_.devices) engines_.push_back(device.name);
    for (std::uint32_t t = 0; t < tasks; ++t) add_task(t);
    fill_least();
  }

  const profile::Machine& machine() const override { return machine_; }
  const Pipeline& pipeline() const override { return pipeline_; }
  std::size_t frames() const override { return 10; }
  const std::vector<Place>& places(std::uint32_t task) const override { return places_[task]; }

  std::string name(const TaskPlacement& placement) const override {
    std::string text;
    for (std::uint32_t t = 0; t < placement.size(); ++t) {
      text += (t == 0 ? "" : ",") + pipeline_.tasks[t].name + "=" + places_[t][placement[t]].name;
    }
    return text;
  }

  std::string infeasible(const TaskPlacement& placement) const override {
    for (std::uint32_t d = 0; d < machine_.devices.size(); ++d) {
      const profile::DeviceProfile& device = machine_.devices[d].profile;
      const profile::Area needed = area(placement, d);
      if (device.type != profile::DeviceType::fpga || model::fits(needed, device)) continue;
      return "does not fit " + machine_.devices[d].name + ": LUT " + std::to_string(needed.lut);
    }
    return "";
  }
  profile::Area area(const TaskPlacement& placement, std::uint32_t device) const override {
    profile::Area sum;
    for (std::uint32_t t = 0; t < placement.size(); ++t) {
      if (places_[t][placement[t]].index == device) sum.lut += lut_[t];
    }
    return sum;
  }
  double price(const TaskPlacement& placement) const override {
    double sum = machine_.nodes[0].host.price_usd;
    for (const std::uint32_t d : used(placement)) sum += machine_.devices[d].profile.price_usd;
    return sum;
  }

  Figures quick(const TaskPlacement& placement) const override {
    ++evaluations;
    const std::vector<double> end = ends(placement);
    const double latency = *std::max_element(end.begin(), end.end());
    double dynamic = 0, frame = static_cast<double>(pipeline_.period_ns);
    for (std::uint32_t t = 0; t < placement.size(); ++t) {
      dynamic += least(t, placement[t]).energy_j.any;
    }
    for (std::uint32_t d = 0; d < machine_.devices.size(); ++d)
      frame = std::max(frame, busy(placement, d));
    double idle = machine_.nodes[0].host.power.idle_w;
    for (const std::uint32_t d : used(placement)) idle += machine_.devices[d].profile.power.idle_w;
    const double n = static_cast<double>(frames());
    Figures f;
    // Where an engine is overloaded, each frame waits longer than the one before.
    const double late = frame - static_cast<double>(pipeline_.period_ns);
    f.latency.p50 = static_cast<timeline::Ns>(std::ceil(latency + late * (n / 2 - 1)));
    f.latency.p99 = f.latency.max = static_cast<timeline::Ns>(std::ceil(latency + late * (n - 1)));
    f.latency.mean = latency + late * (n - 1) / 2;
    f.throughput_hz = 1e9 / frame;
    const double makespan = frame * (n - 1) + latency;
    f.makespan = static_cast<timeline::Ns>(makespan);
    f.energy_per_frame_j = dynamic + idle * makespan * 1e-9 / n;
    f.power_w = f.energy_per_frame_j * n / makespan * 1e9;
    f.price_usd = price(placement);
    return f;
  }

  Figures evaluate(const TaskPlacement& placement) const override {
    Figures f = quick(placement);
    for (std::uint32_t t = 0; t < placement.size(); ++t) {
      TaskFigures task;
      task.duration.mean = task.alone_ns = least(t, placement[t]).duration_ns.any;
      task.latency.mean = ends(placement)[t];
      f.tasks.push_back(task);
    }
    f.engines = {{engines_[0], f.makespan / 2, 0.5}};
    return f;
  }

  const std::vector<std::string>& engines() const override { return engines_; }
  const Least& least(std::uint32_t task, std::uint32_t place) const override {
    return least_[task][place];
  }

  std::unique_ptr<Evaluator> with(const Speeds& speeds) const override {
    auto copy = std::make_unique<Synthetic>(*this);
    for (std::uint32_t t = 0; t < places_.size(); ++t) {
      for (std::uint32_t p = 0; p < places_[t].size(); ++p) {
        copy->duration_[t][p] = duration_[t][p] / speeds.devices[places_[t][p].index];
      }
    }
    copy->fill_least();
    return copy;
  }

  Synthetic(const Synthetic& o)
      : machine_(o.machine_),
        pipeline_(o.pipeline_),
        places_(o.places_),
        duration_(o.duration_),
        lut_(o.lut_),
        engines_(o.engines_) {}

  profile::Machine machine_;
  Pipeline pipeline_;
  std::vector<std::vector<Place>> places_;
  std::vector<std::vector<double>>
      duration_;                    ///< by task and place; call fill_least() after changes
  std::vector<std::uint64_t> lut_;  ///< by task
  mutable std::atomic<std::uint64_t> evaluations = 0;

  void fill_least() {
    least_.clear();
    for (std::uint32_t t = 0; t < places_.size(); ++t) {
      least_.emplace_back();
      for (std::uint32_t p = 0; p < places_[t].size(); ++p) {
        const double d = duration_[t][p];
        const double watts = machine_.devices[places_[t][p].index].profile.power.busy_w;
        least_[t].push_back(
            {{d, d}, {watts * d * 1e-9, watts * d * 1e-9}, {{places_[t][p].index, {d, d}}}});
      }
    }
  }

 private:
  std::size_t pick(std::size_t n) { return random_() % n; }

  void add_task(std::uint32_t t) {
    PipelineTask task;
    task.name = std::string("t").append(std::to_string(t));
    task.branch = t % 2 == 0 ? "even" : "odd";
    for (std::uint32_t from = 0; from < t; ++from) {
      if (pick(2) == 0) task.inputs.push_back({from, "out"});
    }
    pipeline_.tasks.push_back(std::move(task));
    pipeline_.outputs.push_back(t);
    places_.emplace_back();
    duration_.emplace_back();
    for (std::uint32_t d = 0; d < machine_.devices.size(); ++d) {
      if (d + 1 < machine_.devices.size() && pick(4) == 0) continue;
      places_.back().push_back({true, d, machine_.devices[d].name});
      duration_.back().push_back(static_cast<double>(100 + pick(5'000)));
    }
    lut_.push_back(pick(600));
  }

  /// When each task ends: after its inputs and after the tasks before it on its device.
  std::vector<double> ends(const TaskPlacement& placement) const {
    std::vector<double> free(machine_.devices.size(), 0), end;
    for (std::uint32_t t = 0; t < placement.size(); ++t) {
      double& engine = free[places_[t][placement[t]].index];
      double start = engine;
      for (const Input& input : pipeline_.tasks[t].inputs) {
        start = std::max(start, end[input.task]);
      }
      end.push_back(start + duration_[t][placement[t]]);
      engine = end.back();
    }
    return end;
  }
  std::vector<std::uint32_t> used(const TaskPlacement& placement) const {
    std::vector<std::uint32_t> devices;
    for (std::uint32_t d = 0; d + 1 < machine_.devices.size(); ++d) {
      if (busy(placement, d) > 0) devices.push_back(d);
    }
    return devices;
  }
  double busy(const TaskPlacement& placement, std::uint32_t device) const {
    double sum = 0;
    for (std::uint32_t t = 0; t < placement.size(); ++t) {
      if (places_[t][placement[t]].index == device) sum += duration_[t][placement[t]];
    }
    return sum;
  }

  std::mt19937 random_;
  std::vector<std::vector<Least>> least_;
  std::vector<std::string> engines_;
};

}  // namespace partita::partition::test

#endif  // PARTITA_TESTS_PARTITION_SYNTHETIC_H
