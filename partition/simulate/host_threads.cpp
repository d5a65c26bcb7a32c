#include "partition/simulate/host_threads.h"

#include <algorithm>

namespace partita::partition {

using timeline::Placed;

std::vector<Freedom> freedom_of(const Scene& scene, const Compiler& compiler) {
  const timeline::Layout& layout = compiler.layout();
  struct Use {
    std::uint64_t drawn = 0;    ///< of the memory
    std::uint32_t threads = 0;  ///< of the node, or the device
    bool kernels_on_cores = false;
  };
  const std::size_t nodes = layout.nodes.size();
  std::vector<Use> uses(nodes + layout.devices.size());  // numbered as Compiler::memory_of()
  for (const CompiledTask* task : scene.tasks) {
    ++uses[task->node].threads;
    uses[task->node].drawn += task->host_share;
    if (task->device == kNone) continue;
    ++uses[nodes + task->device].threads;
    if (layout.devices[task->device].is_host_cpu) uses[task->node].kernels_on_cores = true;
    const std::uint32_t memory = compiler.memory_of(task->device);
    if (memory != kNone) uses[memory].drawn += task->device_share;
  }
  const auto calm = [&](std::uint32_t memory) {
    return memory == kNone || uses[memory].drawn <= timeline::Bandwidth::kWhole;
  };
  std::vector<Freedom> all(scene.tasks.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::uint32_t node = scene.tasks[i]->node, device = scene.tasks[i]->device;
    Freedom& free = all[i];
    free.host = !uses[node].kernels_on_cores && uses[node].threads <= layout.nodes[node].cores &&
                calm(node);
    if (device == kNone || scene.swaps[device]) continue;
    const bool calm_memory = calm(compiler.memory_of(device));
    const bool cpu = layout.devices[device].is_host_cpu;
    free.circuits = calm_memory;
    free.link = calm_memory && uses[nodes + device].threads == 1;
    free.device = free.link && !cpu;
    free.bursts = cpu || calm_memory;
  }
  return all;
}

HostThreads::HostThreads(const Compiler& compiler)
    : compiler_(compiler), placement_(compiler.layout(), nullptr) {}

void HostThreads::reset(std::size_t count, std::span<const Ns> taken) {
  placement_.restore(taken);
  threads_.assign(count, {});
  held_.assign(compiler_.slots().size(), 0);
}

Placed HostThreads::placed(const HostThread& t, const Op& op, Ns ready) {
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

void HostThreads::step(HostThread& t, const Op& op) {
  if (op.type == OpType::finish) return block(t, t.queue_end);
  const bool free = undisturbed(t, op);
  if (op.type == OpType::host) {
    if (free) held_[op.slot] += op.alone;
    t.clock = free ? t.clock + op.alone : placed(t, op, t.clock).end;
    return;
  }
  if (free && !t.free.device) held_[op.slot] += op.alone;
  t.clock += t.task->api_ns;
  const Ns ready = std::max(t.clock + t.task->submit_ns, t.queue_end);
  t.queue_end = free ? ready + op.alone : placed(t, op, ready).end;
  if (op.blocking) block(t, t.queue_end);
}

/// As many of a burst's commands as the thread enqueues before it is anybody else's turn.
std::size_t HostThreads::burst(HostThread& t, const CompiledFrame& program, std::size_t first,
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

std::size_t HostThreads::steps(std::uint32_t i, const CompiledFrame& program, std::size_t first,
                               Ns until) {
  HostThread& t = threads_[i];
  // With nobody beside it and nothing left of the frame before, it takes what it always does.
  if (first == 0 && t.free.device && t.free.host && t.queue_end <= t.clock) {
    if (program.free.queue_end > 0) t.queue_end = t.clock + program.free.queue_end;
    t.clock += program.free.duration;
    held_[t.task->node] += program.free.host;
    return program.ops.size();
  }
  std::size_t at = first;
  do {
    const Op& op = program.ops[at];
    if (t.free.device && op.free_run != kNone) {
      const FreeRun& run = program.free_runs[op.free_run];
      t.queue_end = std::max(t.clock + run.after_host, t.queue_end + run.after_queue);
      t.clock += run.host;
      at += run.ops;
      continue;
    }
    const std::size_t count = t.free.bursts && op.burst > 1 ? burst(t, program, at, until) : 0;
    if (count == 0) step(t, op);
    at += std::max<std::size_t>(count, 1);
  } while (at < program.ops.size() && (t.clock < until || undisturbed(t, program.ops[at])));
  return at - first;
}

void HostThreads::finish(std::uint32_t i, const CompiledFrame& program) {
  if (!threads_[i].free.device) return;
  for (const auto& [slot, ns] : program.held) held_[slot] += ns;
}

void HostThreads::load(std::uint32_t i) {
  HostThread& t = threads_[i];
  t.clock += t.task->api_ns;
  const Ns ready = std::max(t.clock + t.task->submit_ns, t.queue_end);
  const timeline::Demand demand{compiler_.load_ns(t.task->device), 0, 0, 0, 1};
  t.queue_end = placement_.load(0, t.task->device, ready, demand).end;
}

}  // namespace partita::partition
