#include "partition/simulate/compiled_clock.h"

#include <algorithm>

namespace partita::partition {

using timeline::Placed;

CompiledClock::CompiledClock(const Compiler& compiler)
    : compiler_(compiler), placement_(compiler.layout(), nullptr) {}

void CompiledClock::reset(const Scene& scene) {
  scene_ = &scene;
  placement_.clear();
  threads_.assign(scene.tasks.size(), {});
  posts_.assign(scene.tasks.size() * scene.frames, Trace::kNot);
  delivered_.assign(scene.channels->all.size() * compiler_.layout().nodes.size() * scene.frames,
                    Trace::kNot);
  held_.assign(compiler_.slots().size(), 0);
  link_bytes_.assign(compiler_.layout().links.size(), 0);
  for (std::size_t i = 0; i < threads_.size(); ++i) {
    threads_[i].task = scene.tasks[i];
    threads_[i].node_wakeup = compiler_.layout().nodes[scene.tasks[i]->node].wakeup_ns;
  }
  find_free();
}

/// Which engines and memories nobody can be disturbed on. A task has at most one command of its
/// queue and one host step at work at a time; a memory that can serve the largest of all of them at
/// once never makes anybody wait, and neither do as many cores as there are threads.
void CompiledClock::find_free() {
  const timeline::Layout& layout = compiler_.layout();
  std::vector<std::uint64_t> drawn(layout.nodes.size() + layout.devices.size(), 0);
  std::vector<std::uint32_t> threads(layout.nodes.size(), 0), users(layout.devices.size(), 0);
  std::vector<bool> kernels_on_cores(layout.nodes.size(), false);
  for (const CompiledTask* task : scene_->tasks) {
    ++threads[task->node];
    drawn[task->node] += task->host_share;
    if (task->device == kNone) continue;
    ++users[task->device];
    if (layout.devices[task->device].is_host_cpu) kernels_on_cores[task->node] = true;
    const std::uint32_t memory = compiler_.memory_of(task->device);
    if (memory != kNone) drawn[memory] += task->device_share;
  }
  const auto calm = [&](std::uint32_t memory) {
    return memory == kNone || drawn[memory] <= timeline::Bandwidth::kWhole;
  };
  for (Thread& t : threads_) {
    const std::uint32_t node = t.task->node;
    t.host_free =
        !kernels_on_cores[node] && threads[node] <= layout.nodes[node].cores && calm(node);
    const std::uint32_t device = t.task->device;
    if (device == kNone || scene_->swaps[device]) continue;
    const bool calm_memory = calm(compiler_.memory_of(device));
    const bool cpu = layout.devices[device].is_host_cpu;
    t.circuits_free = calm_memory;
    t.link_free = calm_memory && users[device] == 1;
    t.device_free = t.link_free && !cpu;
    t.bursts = cpu || calm_memory;
  }
}

Placed CompiledClock::placed(const Thread& t, const Op& op, Ns ready) {
  const OpDetail& d = t.task->details[op.detail];
  const timeline::Prepared& prepared = t.task->prepared[op.detail];
  const std::uint32_t device = t.task->device;
  switch (op.type) {
    case OpType::kernel:
      return placement_.kernel(0, device, d.name, compiler_.names()[d.name], d.compute_units, ready,
                               prepared);
    case OpType::copy:
      return placement_.inside(0, device, ready, prepared);
    case OpType::host:
      return placement_.core(0, t.task->node, ready, prepared);
    default:
      if (d.bytes == 0) return {ready, ready};
      return placement_.local_transfer(0, device, op.type == OpType::write, ready, prepared);
  }
}

void CompiledClock::step(Thread& t, const Op& op) {
  if (op.type == OpType::finish) return block(t, t.queue_end);
  const bool free = undisturbed(t, op);
  if (op.type == OpType::host) {
    if (free) held_[op.slot] += op.alone;
    t.clock = free ? t.clock + op.alone : placed(t, op, t.clock).end;
    return;
  }
  if (free && !t.device_free) held_[op.slot] += op.alone;
  t.clock += t.task->api_ns;
  const Ns ready = std::max(t.clock + t.task->submit_ns, t.queue_end);
  t.queue_end = free ? ready + op.alone : placed(t, op, ready).end;
  if (op.blocking) block(t, t.queue_end);
}

/// As many of a burst's commands as the thread enqueues before it is anybody else's turn.
std::size_t CompiledClock::burst(Thread& t, const CompiledFrame& program, std::size_t first,
                                 Ns until) {
  const Op& op = program.ops[first];
  const Ns api = t.task->api_ns;
  std::size_t count = op.burst;
  if (t.clock >= until) return 0;
  if (api > 0) count = std::min<std::size_t>(count, (until - 1 - t.clock) / api + 1);
  const Ns ready = std::max(t.clock + api + t.task->submit_ns, t.queue_end);
  if (!placement_.append(t.task->device, ready, {&t.task->prepared[op.detail], count},
                         t.queue_end)) {
    return 0;
  }
  t.clock += count * api;
  return count;
}

std::size_t CompiledClock::steps(std::uint32_t i, std::size_t, const CompiledFrame& program,
                                 std::size_t first, Ns until) {
  Thread& t = threads_[i];
  // With nobody beside it and nothing left of the frame before, it takes what it always does.
  if (first == 0 && t.device_free && t.host_free && t.queue_end <= t.clock) {
    if (program.free.queue_end > 0) t.queue_end = t.clock + program.free.queue_end;
    t.clock += program.free.duration;
    held_[t.task->node] += program.free.host;
    return program.ops.size();
  }
  std::size_t at = first;
  do {
    const Op& op = program.ops[at];
    if (t.device_free && op.free_run != kNone) {
      const FreeRun& run = program.free_runs[op.free_run];
      t.queue_end = std::max(t.clock + run.after_host, t.queue_end + run.after_queue);
      t.clock += run.host;
      at += run.ops;
      continue;
    }
    const std::size_t count = t.bursts && op.burst > 1 ? burst(t, program, at, until) : 0;
    if (count == 0) step(t, op);
    at += std::max<std::size_t>(count, 1);
  } while (at < program.ops.size() && (t.clock < until || undisturbed(t, program.ops[at])));
  return at - first;
}

void CompiledClock::load(std::uint32_t i) {
  Thread& t = threads_[i];
  t.clock += t.task->api_ns;
  const Ns ready = std::max(t.clock + t.task->submit_ns, t.queue_end);
  const timeline::Demand demand{compiler_.load_ns(t.task->device), 0, 0, 0, 1};
  t.queue_end = placement_.load(0, t.task->device, ready, demand).end;
}

/// Sent to a node when it was posted, once; who waits for it pays for waking up.
void CompiledClock::deliver(std::uint32_t i, std::uint32_t channel, std::size_t frame,
                            std::uint32_t home, Ns posted) {
  Thread& t = threads_[i];
  const std::size_t nodes = compiler_.layout().nodes.size();
  Ns end = posted;
  if (home != t.task->node) {
    Ns& there = delivered_[(channel * nodes + t.task->node) * scene_->frames + frame];
    if (there == Trace::kNot) {
      const std::uint64_t bytes = scene_->channels->all[channel].bytes;
      there = placement_.network(0, home, t.task->node, posted, bytes).end;
      if (bytes > 0) link_bytes_[compiler_.link_between(home, t.task->node)] += bytes;
    }
    end = there;
  }
  if (end > t.clock) t.clock = end + t.node_wakeup;
}

void CompiledClock::sensor(std::uint32_t i, std::size_t frame) {
  deliver(i, scene_->channels->sensors[i], frame, compiler_.layout().sensor_node,
          frame * scene_->pipeline->period_ns);
}

void CompiledClock::message(std::uint32_t i, std::uint32_t input, std::size_t frame) {
  const std::uint32_t channel = scene_->channels->inputs[i][input];
  const std::uint32_t from = scene_->channels->all[channel].from;
  deliver(i, channel, frame, scene_->tasks[from]->node, posts_[from * scene_->frames + frame]);
}

Ns CompiledClock::post(std::uint32_t i, std::size_t frame) {
  if (threads_[i].device_free) {
    for (const auto& [slot, ns] : threads_[i].task->frame(frame + scene_->offset).held) {
      held_[slot] += ns;
    }
  }
  return posts_[i * scene_->frames + frame] = threads_[i].clock;
}

Consumption CompiledClock::consumption(const Trace& trace) const {
  const timeline::Layout& layout = compiler_.layout();
  Consumption c;
  c.device_busy.assign(layout.devices.size(), 0);
  c.node_busy.assign(layout.nodes.size(), 0);
  c.device_bytes.assign(layout.devices.size(), 0);
  c.node_bytes.assign(layout.nodes.size(), 0);
  c.link_bytes = link_bytes_;
  c.makespan = horizon();
  const auto add = [&c](timeline::EngineKind kind, std::uint32_t node, std::uint32_t device,
                        Ns busy) {
    if (kind == timeline::EngineKind::core) c.node_busy[node] += busy;
    if (kind == timeline::EngineKind::compute) c.device_busy[device] += busy;
  };
  const auto& slots = compiler_.slots();
  for (std::size_t s = 0; s < slots.size(); ++s) {
    add(slots[s].kind, slots[s].node, slots[s].device, held_[s]);
  }
  const auto& engines = placement_.engines();
  for (std::size_t e = 0; e < engines.size(); ++e) {
    add(engines[e].kind, engines[e].node, engines[e].device, placement_.worked()[e]);
  }
  for (std::size_t i = 0; i < scene_->tasks.size(); ++i) {
    const CompiledTask& task = *scene_->tasks[i];
    for (std::size_t k = 0; k < scene_->frames; ++k) {
      if (trace.tasks[i].end[k] == Trace::kNot) continue;
      const CompiledFrame& frame = task.frame(k + scene_->offset);
      if (task.device != kNone) c.device_bytes[task.device] += frame.device_bytes;
      c.node_bytes[task.node] += frame.node_bytes;
    }
  }
  return c;
}

Ns CompiledClock::horizon() const {
  Ns latest = 0;
  for (const Thread& t : threads_) latest = std::max({latest, t.clock, t.queue_end});
  return latest;
}

}  // namespace partita::partition
