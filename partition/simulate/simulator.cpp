#include "partition/simulate/simulator.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
#include <tuple>

#include "devices/model/area.h"
#include "partition/simulate/compiled_clock.h"
#include "partition/simulate/periodic.h"
#include "partition/simulate/reference.h"

namespace partita::partition {
namespace {

using profile::Error;

/// "1020" as "1,020".
std::string grouped(std::uint64_t value) {
  const std::string digits = std::to_string(value);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

struct Resource {
  const char* name;
  std::uint64_t profile::Area::*member;
};
constexpr std::array kResources{
    Resource{"LUT", &profile::Area::lut}, Resource{"FF", &profile::Area::ff},
    Resource{"BRAM36", &profile::Area::bram36}, Resource{"URAM", &profile::Area::uram},
    Resource{"DSP", &profile::Area::dsp}};

}  // namespace

class Simulator::Impl {
 public:
  Impl(const profile::Machine& machine, const Pipeline& pipeline, const Workload& workload,
       SimulatorOptions options);

  /// What one simulation needs and the next one can use again.
  struct Scratch {
    Scratch(const Compiler& compiler, const Pipeline& pipeline)
        : clock(compiler), recalling(compiler), periodic(pipeline, recalling, trace) {}
    CompiledClock clock;
    RecallingClock recalling;
    Trace trace;
    Periodic periodic;
    Scene scene;
    /// Where nearly everything is new, as on few placements of a machine whose parts all share one
    /// memory, remembering costs more than it gives: that many placements go without, then one
    /// tries again.
    std::size_t pause = 0, tried = 0;
  };

  void set_scene(const TaskPlacement& placement, Scene& scene) const;
  void check_placement(const TaskPlacement& placement) const;
  double alone_ns(std::uint32_t task, std::uint32_t place) const;
  std::string misfit(const TaskPlacement& placement, std::uint32_t device) const;
  template <typename Use>
  auto with_scratch(const Use& use) const;
  Figures simulate(Scratch& scratch) const;
  Figures recall(Scratch& scratch) const;
  Figures priced(const Scratch& scratch, Figures figures, const Consumption& used) const;
  void add_engines(const Scratch& scratch, Figures& figures) const;

  const profile::Machine& machine_;
  const Pipeline& pipeline_;
  const Workload& workload_;
  SimulatorOptions options_;
  Compiler compiler_;
  Channels channels_;
  std::vector<const TaskWork*> works_;               ///< by task
  std::vector<std::vector<Place>> places_;           ///< by task
  std::vector<std::vector<CompiledTask>> compiled_;  ///< by task and place
  Cycle cycle_;

 private:
  void find_places();
  void find_channels();
  std::uint32_t channel(std::uint32_t from, const std::string& name, std::uint64_t bytes);
  void compile();

  mutable std::mutex mutex_;
  mutable std::vector<std::vector<std::optional<double>>> alone_ns_;  ///< by task and place
  mutable std::vector<std::unique_ptr<Scratch>> idle_;
};

Simulator::Impl::Impl(const profile::Machine& machine, const Pipeline& pipeline,
                      const Workload& workload, SimulatorOptions options)
    : machine_(machine),
      pipeline_(pipeline),
      workload_(workload),
      options_(std::move(options)),
      compiler_(machine, options_.speeds) {
  if (options_.frames < 1 || options_.frames > 100'000) {
    throw Error("simulator: " + std::to_string(options_.frames) + " frames, expected 1 to 100000");
  }
  for (const PipelineTask& task : pipeline.tasks) {
    works_.push_back(workload.find(task.name));
    if (works_.back() == nullptr) {
      throw Error("pipeline '" + pipeline.id + "': task '" + task.name +
                  "' is not in the workload (" + workload.origin + ")");
    }
  }
  find_places();
  find_channels();
  compile();
  cycle_ = cycle_of(pipeline, works_, options_.frames);
}

void Simulator::Impl::find_places() {
  for (const TaskWork* work : works_) {
    std::vector<Place> places;
    if (work->host_only) {
      for (std::uint32_t n = 0; n < machine_.nodes.size(); ++n) {
        places.push_back({false, n, machine_.nodes[n].name + "/" + machine_.nodes[n].host.id});
      }
    } else {
      for (std::uint32_t d = 0; d < machine_.devices.size(); ++d) {
        const profile::MachineDevice& device = machine_.devices[d];
        if (work->variants[variant_index(device.profile.type)]) {
          places.push_back({true, d, device.name});
        }
      }
    }
    if (places.empty()) {
      throw Error("task '" + work->name + "' has no variant for any device of machine '" +
                  machine_.id + "'");
    }
    places_.push_back(std::move(places));
  }
}

std::uint32_t Simulator::Impl::channel(std::uint32_t from, const std::string& name,
                                       std::uint64_t bytes) {
  for (std::uint32_t c = 0; c < channels_.all.size(); ++c) {
    const Channel& known = channels_.all[c];
    if (known.from != from || known.name != name) continue;
    if (known.bytes == bytes) return c;
    throw Error("pipeline '" + pipeline_.id + "': sensor '" + name + "' sends " +
                std::to_string(known.bytes) + " and " + std::to_string(bytes) +
                " bytes a frame, expected one size");
  }
  channels_.all.push_back({from, name, bytes});
  return static_cast<std::uint32_t>(channels_.all.size() - 1);
}

void Simulator::Impl::find_channels() {
  const auto& tasks = pipeline_.tasks;
  channels_.inputs.resize(tasks.size());
  channels_.consumers.resize(tasks.size());
  for (std::uint32_t i = 0; i < tasks.size(); ++i) {
    const bool sensed = tasks[i].inputs.empty();
    channels_.sensors.push_back(sensed ? channel(kNone, tasks[i].sensor, tasks[i].sensor_bytes)
                                       : kNone);
    for (const Input& input : tasks[i].inputs) {
      const auto& outputs = works_[input.task]->outputs;
      const auto output = std::find_if(outputs.begin(), outputs.end(),
                                       [&](const Output& o) { return o.name == input.output; });
      if (output == outputs.end()) {
        throw Error("pipeline '" + pipeline_.id + "': task '" + tasks[input.task].name +
                    "' has no output '" + input.output + "', which '" + tasks[i].name + "' reads");
      }
      channels_.inputs[i].push_back(channel(input.task, output->name, output->bytes));
      channels_.consumers[input.task].push_back(i);
    }
  }
}

void Simulator::Impl::compile() {
  for (std::uint32_t i = 0; i < works_.size(); ++i) {
    compiled_.emplace_back();
    for (const Place& place : places_[i]) {
      compiled_.back().push_back(compiler_.compile(*works_[i], place));
    }
  }
  for (const auto& places : places_) alone_ns_.emplace_back(places.size());
}

/// The task by itself, fed by a sensor that sends nothing, so seldom that frames never meet: mean
/// over the frames that it does in a simulation.
double Simulator::Impl::alone_ns(std::uint32_t task, std::uint32_t place) const {
  const std::lock_guard lock(mutex_);
  std::optional<double>& known = alone_ns_[task][place];
  if (known) return *known;
  Pipeline single;
  single.period_ns = Ns{1} << 42;
  single.tasks = {{.name = pipeline_.tasks[task].name, .branch = {}, .inputs = {}}};
  single.outputs = single.perception = {0};
  const Channels channels{{{kNone, "", 0}}, {{}}, {0}, {{}}};
  const CompiledTask& compiled = compiled_[task][place];
  const std::size_t programs = std::min(compiled.frames.size(), options_.frames);
  Scratch scratch(compiler_, pipeline_);
  scratch.scene = {&single, &channels,   programs,
                   0,       {&compiled}, std::vector<bool>(machine_.devices.size(), false)};
  scratch.clock.reset(scratch.scene);
  Driver<CompiledClock>(scratch.scene, scratch.clock, scratch.trace).run();
  const Trace::Task& alone = scratch.trace.tasks[0];
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < options_.frames; k += pipeline_.tasks[task].every, ++count) {
    const std::size_t program = k % compiled.frames.size();
    sum += static_cast<double>(alone.end[program] - alone.start[program]);
  }
  return known.emplace(sum / static_cast<double>(count));
}

void Simulator::Impl::check_placement(const TaskPlacement& placement) const {
  bool valid = placement.size() == places_.size();
  for (std::size_t i = 0; valid && i < placement.size(); ++i) {
    valid = placement[i] < places_[i].size();
  }
  if (!valid) throw Error("simulator: a placement that is not of this pipeline and machine");
}

void Simulator::Impl::set_scene(const TaskPlacement& placement, Scene& scene) const {
  check_placement(placement);
  scene.pipeline = &pipeline_;
  scene.channels = &channels_;
  scene.frames = options_.frames;
  scene.swaps.assign(machine_.devices.size(), false);
  scene.tasks.clear();
  for (std::size_t i = 0; i < placement.size(); ++i) {
    scene.tasks.push_back(&compiled_[i][placement[i]]);
  }
  for (std::uint32_t d = 0; d < machine_.devices.size(); ++d) {
    scene.swaps[d] = options_.allow_swap && !misfit(placement, d).empty();
  }
}

/// Why the tasks on an FPGA do not fit it together; empty if they do.
std::string Simulator::Impl::misfit(const TaskPlacement& placement, std::uint32_t device) const {
  const profile::MachineDevice& on = machine_.devices[device];
  if (on.profile.type != profile::DeviceType::fpga) return "";
  for (const Resource& resource : kResources) {
    std::uint64_t needed = 0;
    std::string parts;
    for (std::size_t i = 0; i < placement.size(); ++i) {
      const Place& place = places_[i][placement[i]];
      const std::uint64_t own = works_[i]->area.*resource.member;
      if (!place.is_device || place.index != device || own == 0) continue;
      needed += own;
      parts += (parts.empty() ? "" : " + ") + works_[i]->name + " " + grouped(own);
    }
    const std::uint64_t has = on.profile.fabric.area.*resource.member;
    if (needed <= has) continue;
    return "does not fit " + on.name + ": " + resource.name + " " + grouped(needed) + " of " +
           grouped(has) + " needed by " + parts;
  }
  return "";
}

template <typename Use>
auto Simulator::Impl::with_scratch(const Use& use) const {
  std::unique_ptr<Scratch> scratch;
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      scratch = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (!scratch) scratch = std::make_unique<Scratch>(compiler_, pipeline_);
  auto result = use(*scratch);
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(scratch));
  return result;
}

/// Of scratch.scene, every command of every frame.
Figures Simulator::Impl::simulate(Scratch& scratch) const {
  scratch.clock.reset(scratch.scene);
  Driver<CompiledClock>(scratch.scene, scratch.clock, scratch.trace).run();
  return priced(scratch, figures_of(scratch.trace, scratch.scene), scratch.clock.consumption());
}

/// The same, without what is known and what repeats.
Figures Simulator::Impl::recall(Scratch& scratch) const {
  const auto& swaps = scratch.scene.swaps;
  // A bitstream outlives its frame, and its load moves whoever is on the device.
  if (std::find(swaps.begin(), swaps.end(), true) != swaps.end()) return simulate(scratch);
  RecallingClock& clock = scratch.recalling;
  if (const PeriodicRun* run = scratch.periodic.run(scratch.scene, cycle_)) {
    return priced(scratch, run->figures, run->consumption);
  }
  if (scratch.pause > 0) {
    --scratch.pause;
    return simulate(scratch);
  }
  clock.reset(scratch.scene);
  Repetition repetition(scratch.scene, cycle_.length);
  Driver<RecallingClock, Repetition>(scratch.scene, clock, scratch.trace, &repetition).run();
  constexpr std::size_t kFewTries = 4, kPause = 8, kMostlyNew = 5;  // moments a frame
  const bool mostly_new = clock.simulated() > kMostlyNew * options_.frames * ++scratch.tried;
  if (mostly_new && scratch.tried >= kFewTries) scratch.pause = kPause;
  if (!clock.exact()) return simulate(scratch);
  return priced(scratch, figures_of(scratch.trace, scratch.scene), clock.consumption());
}

Figures Simulator::Impl::priced(const Scratch& scratch, Figures figures,
                                const Consumption& used) const {
  const Parts parts = parts_of(scratch.scene, machine_);
  set_energy(figures, scratch.scene, joules(used, parts, machine_), used.makespan);
  figures.price_usd = price_of(parts, machine_);
  return figures;
}

/// Of each engine, the time with a calendar and without.
void Simulator::Impl::add_engines(const Scratch& scratch, Figures& figures) const {
  EngineUses uses(machine_);
  const auto& slots = compiler_.slots();
  for (std::size_t s = 0; s < slots.size(); ++s) {
    uses.add(slots[s].name, slots[s].kind, slots[s].node,
             scratch.clock.threads().held_by_slot()[s]);
  }
  const CompiledClock& clock = scratch.clock;
  for (const auto* calendars : {&clock.threads().calendars(), &clock.messages().calendars()}) {
    for (std::size_t e = 0; e < calendars->engines().size(); ++e) {
      const timeline::Engine& engine = calendars->engines()[e];
      uses.add(engine.name, engine.kind, engine.node, calendars->worked()[e]);
    }
  }
  figures.engines = uses.by_share(figures.makespan);
}

Simulator::Simulator(const profile::Machine& machine, const Pipeline& pipeline,
                     const Workload& workload, SimulatorOptions options)
    : impl_(std::make_unique<Impl>(machine, pipeline, workload, std::move(options))) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;

const profile::Machine& Simulator::machine() const {
  return impl_->machine_;
}
const Pipeline& Simulator::pipeline() const {
  return impl_->pipeline_;
}
const Workload& Simulator::workload() const {
  return impl_->workload_;
}
const SimulatorOptions& Simulator::options() const {
  return impl_->options_;
}
const std::vector<Place>& Simulator::places(std::uint32_t task) const {
  return impl_->places_.at(task);
}

std::string Simulator::name(const TaskPlacement& placement) const {
  impl_->check_placement(placement);
  std::string name;
  for (std::size_t i = 0; i < placement.size(); ++i) {
    name += (i == 0 ? "" : ",") + impl_->pipeline_.tasks[i].name + "=" +
            impl_->places_[i][placement[i]].name;
  }
  return name;
}

std::string Simulator::infeasible(const TaskPlacement& placement) const {
  impl_->check_placement(placement);
  for (std::uint32_t d = 0; d < impl_->machine_.devices.size(); ++d) {
    const std::string misfit = impl_->misfit(placement, d);
    if (misfit.empty()) continue;
    if (!impl_->options_.allow_swap) return misfit;
    for (std::size_t i = 0; i < placement.size(); ++i) {
      const Place& place = impl_->places_[i][placement[i]];
      if (!place.is_device || place.index != d) continue;
      const profile::MachineDevice& on = impl_->machine_.devices[d];
      if (!model::fits(impl_->works_[i]->area, on.profile)) return misfit;
    }
  }
  return "";
}

profile::Area Simulator::area(const TaskPlacement& placement, std::uint32_t device) const {
  impl_->check_placement(placement);
  profile::Area sum;
  for (std::size_t i = 0; i < placement.size(); ++i) {
    const Place& place = impl_->places_[i][placement[i]];
    if (place.is_device && place.index == device) {
      sum = model::operator+(sum, impl_->works_[i]->area);
    }
  }
  return sum;
}

double Simulator::price(const TaskPlacement& placement) const {
  Scene scene;
  impl_->set_scene(placement, scene);
  return price_of(parts_of(scene, impl_->machine_), impl_->machine_);
}

Figures Simulator::quick(const TaskPlacement& placement) const {
  return impl_->with_scratch([&](Impl::Scratch& scratch) {
    impl_->set_scene(placement, scratch.scene);
    return impl_->recall(scratch);
  });
}

Figures Simulator::run(const TaskPlacement& placement) const {
  return impl_->with_scratch([&](Impl::Scratch& scratch) {
    impl_->set_scene(placement, scratch.scene);
    Figures figures = impl_->simulate(scratch);
    add_details(scratch.trace, scratch.scene, figures);
    for (std::size_t i = 0; i < figures.tasks.size(); ++i) {
      figures.tasks[i].alone_ns = impl_->alone_ns(static_cast<std::uint32_t>(i), placement[i]);
    }
    impl_->add_engines(scratch, figures);
    return figures;
  });
}

Reference Simulator::reference(const TaskPlacement& placement) const {
  Scene scene;
  impl_->set_scene(placement, scene);
  ReferenceRun run = run_reference(scene, impl_->compiler_);
  const Parts parts = parts_of(scene, impl_->machine_);
  Figures figures = figures_of(run.trace, scene);
  set_energy(figures, scene, reference_joules(run, parts, impl_->machine_), run.schedule.makespan);
  figures.price_usd = price_of(parts, impl_->machine_);
  add_details(run.trace, scene, figures);
  for (std::size_t i = 0; i < figures.tasks.size(); ++i) {
    figures.tasks[i].alone_ns = impl_->alone_ns(static_cast<std::uint32_t>(i), placement[i]);
  }
  figures.engines = engines_of(run, impl_->machine_);
  return {std::move(run.record), std::move(run.schedule), std::move(figures)};
}

}  // namespace partita::partition
