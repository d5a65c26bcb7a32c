#include "partition/simulate/reference.h"

namespace partita::partition {
namespace {

using timeline::Command;
using timeline::CommandKind;
using timeline::NameId;
using timeline::NodeId;
using timeline::QueueId;
using timeline::ThreadId;
using timeline::Timeline;

CommandKind kind_of(OpType type) {
  switch (type) {
    case OpType::write:
      return CommandKind::write;
    case OpType::read:
      return CommandKind::read;
    case OpType::copy:
      return CommandKind::copy;
    default:
      return CommandKind::kernel;
  }
}

/// What Driver wants of a clock, on the real Timeline.
class TimelineClock {
 public:
  static constexpr bool kLooksAhead = false;
  static constexpr bool moved_others() { return false; }

  TimelineClock(const Scene& scene, const Compiler& compiler)
      : scene_(scene), compiler_(compiler), timeline_(compiler.layout()) {
    for (const std::string& name : compiler.names()) names_.push_back(timeline_.intern(name));
    for (const Channel& channel : scene.channels->all) {
      channels_.push_back(timeline_.intern(channel.name));
    }
    posts_.resize(scene.tasks.size() * scene.frames, kNone);
    for (std::uint32_t i = 0; i < scene.tasks.size(); ++i) add_task(i);
  }

  Ns now(std::uint32_t i) const { return timeline_.clock(threads_[i]); }
  Ns wakeup_ns(std::uint32_t i) const {
    return compiler_.layout().nodes[scene_.tasks[i]->node].wakeup_ns;
  }
  void wait_until(std::uint32_t i, Ns time) { timeline_.wait_until(threads_[i], time); }
  void sensor(std::uint32_t i, std::size_t frame) {
    label(i, frame);
    const std::uint32_t channel = scene_.channels->sensors[i];
    timeline_.release(timeline_.sensor_input(threads_[i], channels_[channel],
                                             scene_.channels->all[channel].bytes));
  }
  void message(std::uint32_t i, std::uint32_t input, std::size_t frame) {
    label(i, frame);
    const std::uint32_t channel = scene_.channels->inputs[i][input];
    const Channel& what = scene_.channels->all[channel];
    const NodeId post = posts_[what.from * scene_.frames + frame];
    timeline_.release(timeline_.message(threads_[i], channels_[channel], post, what.bytes));
  }
  void load(std::uint32_t i) {
    Command command;
    command.queue = queues_[i];
    command.kind = CommandKind::load;
    command.demand.launch_ns = compiler_.load_ns(scene_.tasks[i]->device);
    timeline_.release(timeline_.enqueue(threads_[i], command));
  }
  std::size_t steps(std::uint32_t i, std::size_t frame, const CompiledFrame& program,
                    std::size_t first, Ns) {
    step(i, frame, program.ops[first]);
    return 1;
  }
  Ns post(std::uint32_t i, std::size_t frame) {
    label(i, frame);
    const NodeId event = timeline_.create_user_event(threads_[i]);
    timeline_.set_user_event(threads_[i], event, 0);
    posts_[i * scene_.frames + frame] = event;
    return now(i);
  }
  const Timeline& timeline() const { return timeline_; }

 private:
  void step(std::uint32_t i, std::size_t frame, const Op& op);
  void add_task(std::uint32_t i) {
    const CompiledTask& task = *scene_.tasks[i];
    const PipelineTask& own = scene_.pipeline->tasks[i];
    tasks_.push_back(timeline_.intern(own.name));
    threads_.push_back(timeline_.add_thread_at(own.name, task.node, 0));
    queues_.push_back(task.device == kNone ? kNone : timeline_.add_queue(task.device, false));
  }
  void label(std::uint32_t i, std::size_t frame) {
    timeline_.set_label(threads_[i], tasks_[i], static_cast<std::int64_t>(frame));
  }

  const Scene& scene_;
  const Compiler& compiler_;
  Timeline timeline_;
  std::vector<NameId> names_, channels_, tasks_;
  std::vector<ThreadId> threads_;
  std::vector<QueueId> queues_;
  std::vector<NodeId> posts_;
};

void TimelineClock::step(std::uint32_t i, std::size_t frame, const Op& op) {
  const ThreadId thread = threads_[i];
  label(i, frame);
  if (op.type == OpType::finish) {
    timeline_.finish(thread, queues_[i]);
    return;
  }
  const OpDetail& detail = scene_.tasks[i]->details[op.detail];
  const timeline::Demand& demand = scene_.tasks[i]->prepared[op.detail].demand;
  if (op.type == OpType::host) {
    timeline_.release(timeline_.host_step(thread, names_[detail.name], demand, detail.work));
    return;
  }
  Command command;
  command.queue = queues_[i];
  command.kind = kind_of(op.type);
  command.name = names_[detail.name];
  if (op.type == OpType::kernel || op.type == OpType::copy) command.demand = demand;
  command.bytes = detail.bytes;
  command.compute_units = detail.compute_units;
  command.work = detail.work;
  command.launch = detail.launch;
  const NodeId node = timeline_.enqueue(thread, command);
  if (op.blocking) timeline_.wait(thread, {&node, 1});
  timeline_.release(node);
}

}  // namespace

ReferenceRun run_reference(const Scene& scene, const Compiler& compiler) {
  ReferenceRun run;
  TimelineClock clock(scene, compiler);
  Driver<TimelineClock>(scene, clock, run.trace).run();
  run.live_horizon = clock.timeline().horizon();
  run.record = clock.timeline().snapshot();
  run.schedule = timeline::replay(run.record);
  return run;
}

double reference_joules(const ReferenceRun& run, const Parts& parts,
                        const profile::Machine& machine) {
  const double length = static_cast<double>(run.schedule.makespan) * 1e-9;
  double sum = timeline::energy(run.schedule, run.record, machine).total();
  for (std::size_t d = 0; d < machine.devices.size(); ++d) {
    const profile::MachineDevice& device = machine.devices[d];
    if (!parts.devices[d] && !device.is_host_cpu) sum -= device.profile.power.idle_w * length;
  }
  for (std::size_t n = 0; n < machine.nodes.size(); ++n) {
    if (!parts.nodes[n]) sum -= machine.nodes[n].host.power.idle_w * length;
  }
  return sum;
}

std::vector<EngineUse> engines_of(const ReferenceRun& run, const profile::Machine& machine) {
  EngineUses uses(machine);
  for (const timeline::Occupation& o : run.schedule.occupations) {
    if (run.record.commands[o.node].kind == CommandKind::load) continue;
    const timeline::Engine& engine = run.schedule.engines[o.engine];
    uses.add(engine.name, engine.kind, engine.node, o.end - o.start);
  }
  return uses.by_share(run.schedule.makespan);
}

}  // namespace partita::partition
