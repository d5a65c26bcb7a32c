#include "partition/search/simulated.h"

#include <algorithm>
#include <mutex>
#include <optional>

#include "partition/simulate/compile.h"
#include "partition/simulate/figures.h"

namespace partita::partition {
namespace {

using profile::DeviceType;

/// Whether the host has waited for the whole queue when the frame is over. If not, its work may go
/// on when its result is there already.
bool drained(const CompiledFrame& frame) {
  const auto last = std::find_if(frame.ops.rbegin(), frame.ops.rend(),
                                 [](const Op& op) { return op.type != OpType::host; });
  return last == frame.ops.rend() || last->type == OpType::finish || last->blocking;
}

/// The least and the mean over activations.
class Over {
 public:
  void add(double value) {
    least_ = count_ == 0 ? value : std::min(least_, value);
    sum_ += value;
    ++count_;
  }
  AtLeast result() const { return {least_, count_ == 0 ? 0 : sum_ / static_cast<double>(count_)}; }

 private:
  double least_ = 0, sum_ = 0;
  std::size_t count_ = 0;
};

class Simulated : public Evaluator {
 public:
  Simulated(const profile::Machine& machine, const Pipeline& pipeline, const Workload& workload,
            SimulatorOptions options)
      : simulator_(machine, pipeline, workload, std::move(options)),
        compiler_(machine, simulator_.options().speeds) {
    for (const profile::Node& node : machine.nodes) engines_.push_back(node.name + "/cores");
    for (const profile::MachineDevice& device : machine.devices) {
      const std::string& node = machine.nodes[device.node].name;
      engines_.insert(engines_.end(),
                      {device.name, node + ">" + device.name, device.name + ">" + node});
    }
    least_.resize(pipeline.tasks.size());
    for (std::uint32_t t = 0; t < least_.size(); ++t) least_[t].resize(places(t).size());
  }

  const profile::Machine& machine() const override { return simulator_.machine(); }
  const Pipeline& pipeline() const override { return simulator_.pipeline(); }
  std::size_t frames() const override { return simulator_.options().frames; }
  const std::vector<Place>& places(std::uint32_t task) const override {
    return simulator_.places(task);
  }
  std::string name(const TaskPlacement& placement) const override {
    return simulator_.name(placement);
  }
  std::string infeasible(const TaskPlacement& placement) const override {
    return simulator_.infeasible(placement);
  }
  profile::Area area(const TaskPlacement& placement, std::uint32_t device) const override {
    return simulator_.area(placement, device);
  }
  double price(const TaskPlacement& placement) const override {
    return simulator_.price(placement);
  }
  Figures evaluate(const TaskPlacement& placement) const override {
    return simulator_.run(placement);
  }
  Figures quick(const TaskPlacement& placement) const override {
    return simulator_.quick(placement);
  }
  const std::vector<std::string>& engines() const override { return engines_; }

  const Least& least(std::uint32_t task, std::uint32_t place) const override {
    const std::lock_guard lock(mutex_);
    std::optional<Least>& known = least_.at(task).at(place);
    if (!known) known = find_least(task, places(task)[place]);
    return *known;
  }

  std::unique_ptr<Evaluator> with(const Speeds& speeds) const override {
    SimulatorOptions options = simulator_.options();
    options.speeds = speeds;
    return simulated(machine(), pipeline(), simulator_.workload(), std::move(options));
  }

 private:
  Least find_least(std::uint32_t task, const Place& place) const;
  double energy_j(const CompiledTask& task, const CompiledFrame& frame,
                  const FreeFrame& free) const;

  Simulator simulator_;
  mutable std::mutex mutex_;
  mutable Compiler compiler_;
  mutable std::vector<std::vector<std::optional<Least>>> least_;
  std::vector<std::string> engines_;
};

double Simulated::energy_j(const CompiledTask& task, const CompiledFrame& frame,
                           const FreeFrame& free) const {
  const std::size_t devices = machine().devices.size(), nodes = machine().nodes.size();
  Consumption used;
  used.device_busy.assign(devices, 0);
  used.device_bytes.assign(devices, 0);
  used.node_busy.assign(nodes, 0);
  used.node_bytes.assign(nodes, 0);
  used.link_bytes.assign(machine().links.size(), 0);
  used.node_busy[task.node] = free.host;
  used.node_bytes[task.node] = frame.node_bytes;
  if (task.device != kNone) {
    const bool cpu = machine().devices[task.device].is_host_cpu;
    (cpu ? used.node_busy[task.node] : used.device_busy[task.device]) += free.compute;
    used.device_bytes[task.device] = frame.device_bytes;
  }
  const Parts parts{std::vector<bool>(devices, true), std::vector<bool>(nodes, true)};
  return joules(used, parts, machine());
}

Least Simulated::find_least(std::uint32_t task, const Place& place) const {
  const PipelineTask& what = pipeline().tasks[task];
  const TaskWork& work = *simulator_.workload().find(what.name);
  const CompiledTask compiled = compiler_.compile(work, place);
  Over duration, energy, host, compute, to_device, from_device;
  bool drains = true;
  for (std::size_t k = 0; k < frames(); k += what.every) {
    const CompiledFrame& frame = compiled.frame(k);
    const FreeFrame& free = frame.free;
    duration.add(static_cast<double>(free.duration));
    energy.add(energy_j(compiled, frame, free));
    host.add(static_cast<double>(free.host));
    compute.add(static_cast<double>(free.compute));
    to_device.add(static_cast<double>(free.to_device));
    from_device.add(static_cast<double>(free.from_device));
    drains = drains && drained(frame);
  }
  Least least{duration.result(), energy.result(), {}};
  if (!drains) return least;
  const auto add = [&](std::size_t engine, const Over& busy, double share) {
    const AtLeast of = busy.result();
    least.loads.push_back({static_cast<std::uint32_t>(engine), {of.any * share, of.mean * share}});
  };
  const std::uint32_t node = compiled.node;
  const double core = 1.0 / machine().nodes[node].host.performance.units;
  add(node, host, core);
  if (compiled.device == kNone) return least;
  const std::size_t first = machine().nodes.size() + 3 * std::size_t{compiled.device};
  // Circuits of an FPGA are engines of their own; they have nothing to share.
  const DeviceType type = machine().devices[compiled.device].profile.type;
  if (type == DeviceType::cpu) add(node, compute, core);
  if (type == DeviceType::gpu) add(first, compute, 1);
  add(first + 1, to_device, 1);
  add(first + 2, from_device, 1);
  return least;
}

}  // namespace

std::unique_ptr<Evaluator> simulated(const profile::Machine& machine, const Pipeline& pipeline,
                                     const Workload& workload, SimulatorOptions options) {
  return std::make_unique<Simulated>(machine, pipeline, workload, std::move(options));
}

}  // namespace partita::partition
