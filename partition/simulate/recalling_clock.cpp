#include "partition/simulate/recalling_clock.h"

#include <algorithm>
#include <numeric>

namespace partita::partition {
namespace {

constexpr Ns kLater = Trace::kNot - 1;  ///< than the one of the group who is through first

}  // namespace

void RecallingClock::reset(const Scene& scene) {
  scene_ = &scene;
  exact_ = true;
  moved_ = false;
  moments_.bound_memory();
  messages_.reset(scene);
  if (tasks_ != scene.tasks) find_groups();
  for (Thread& t : threads_) {
    t.clock = t.queue_end = 0;
    t.running = t.alone = false;
  }
  for (Group& group : groups_) {
    group.moment = moments_.idle();
    group.since = 0;
    group.running.clear();
  }
  const timeline::Layout& layout = compiler_.layout();
  used_.device_busy.assign(layout.devices.size(), 0);
  used_.node_busy.assign(layout.nodes.size(), 0);
  used_.device_bytes.assign(layout.devices.size(), 0);
  used_.node_bytes.assign(layout.nodes.size(), 0);
  used_.link_bytes.assign(layout.links.size(), 0);
}

/// Joins each task with the devices, cores and memories that it asks a calendar of.
void RecallingClock::find_groups() {
  const timeline::Layout& layout = compiler_.layout();
  const std::vector<Freedom> all_free = freedom_of(*scene_, compiler_);
  tasks_ = scene_->tasks;
  threads_.assign(tasks_.size(), {});
  const std::size_t nodes = layout.nodes.size(), devices = layout.devices.size();
  const std::size_t cores = threads_.size(), on = cores + nodes, memories = on + devices;
  parents_.resize(memories + nodes + devices);
  std::iota(parents_.begin(), parents_.end(), 0u);
  const auto root = [this](std::size_t of) {
    auto at = static_cast<std::uint32_t>(of);
    while (parents_[at] != at) at = parents_[at] = parents_[parents_[at]];
    return at;
  };
  const auto unite = [&](std::size_t a, std::size_t b) { parents_[root(a)] = root(b); };
  for (std::size_t i = 0; i < threads_.size(); ++i) {
    const std::uint32_t device = tasks_[i]->device, node = tasks_[i]->node;
    const Freedom& free = all_free[i];
    threads_[i].task = tasks_[i];
    threads_[i].node_wakeup = layout.nodes[node].wakeup_ns;
    threads_[i].free = free;
    const bool cpu = device != kNone && layout.devices[device].is_host_cpu;
    if (!free.host || cpu) {
      unite(i, cores + node);
      unite(i, memories + node);
    }
    if (device == kNone) continue;
    if (!free.device) unite(i, on + device);
    const std::uint32_t memory = compiler_.memory_of(device);
    if (!free.circuits && memory != kNone) unite(i, memories + memory);
  }
  // Groups are numbered by their first tasks.
  std::uint32_t groups = 0;
  for (std::size_t i = 0; i < threads_.size(); ++i) {
    std::size_t first = 0;
    while (root(first) != root(i)) ++first;
    threads_[i].group = first < i ? threads_[first].group : groups++;
  }
  groups_.resize(groups);
}

void RecallingClock::add(const AllHeld& held) {
  const auto one = [this](const Held& h) {
    (h.cores ? used_.node_busy : used_.device_busy)[h.of] += h.busy;
  };
  for (const Held& h : held.first) {
    if (h.busy > 0) one(h);
  }
  for (const Held& h : held.more) one(h);
}

/// With nobody beside it and nothing left of the frame before, it takes what it always does.
bool RecallingClock::run_alone(Thread& t, const CompiledFrame& program) {
  const std::uint32_t device = t.task->device;
  if (!t.free.host || (device != kNone && !t.free.device) || t.queue_end > t.clock) return false;
  if (program.free.queue_end > 0) t.queue_end = t.clock + program.free.queue_end;
  t.clock += program.free.duration;
  used_.node_busy[t.task->node] += program.free.host;
  if (device != kNone) used_.device_busy[device] += program.free.compute;
  return true;
}

/// Task i begins a program.
void RecallingClock::join(std::uint32_t i, const CompiledFrame& program) {
  Thread& t = threads_[i];
  Group& group = groups_[t.group];
  if (t.clock < group.since) {
    exact_ = false;
    t.clock = group.since;
  }
  if (over(group, t.clock)) {
    group.moment = moments_.idle();
    group.since = t.clock;
  }
  Running joining;
  joining.task = i;
  joining.compiled = t.task;
  joining.program = &program;
  joining.free = t.free;
  joining.clock = t.clock - group.since;
  joining.queue_end = t.queue_end > t.clock ? t.queue_end - group.since : 0;
  const Moments::Start& start = moments_.start(*group.moment, joining);
  add(start.held);
  group.moment = start.after;
  group.since = t.clock;
  group.running.push_back(i);
  t.running = true;
  t.earliest = t.clock + program.free.duration;
}

void RecallingClock::set_bounds(Group& group) {
  group.bound = true;
  for (const std::uint32_t task : group.running) {
    threads_[task].clock = std::max(threads_[task].earliest, group.since);
  }
}

/// Only the first to be through has a time; the others have their turn when they are the first.
void RecallingClock::set_finish(Group& group) {
  group.bound = false;
  moved_ = moved_ || group.running.size() > 1;
  const Moment::Finish& finish = moments_.finish(*group.moment);
  for (const std::uint32_t task : group.running) threads_[task].clock = kLater;
  threads_[finish.task].clock = group.since + finish.time;
}

std::size_t RecallingClock::steps(std::uint32_t i, std::size_t, const CompiledFrame& program,
                                  std::size_t, Ns) {
  Thread& t = threads_[i];
  if (t.alone) {
    t.alone = false;
    return program.ops.size();
  }
  Group& group = groups_[t.group];
  if (!t.running) {
    t.alone = run_alone(t, program);
    if (t.alone) return 0;
    moved_ = moved_ || !group.running.empty();
    join(i, program);
    set_bounds(group);
    return 0;
  }
  const Ns turn = t.clock;
  if (group.bound) set_finish(group);
  return t.clock == turn ? program.ops.size() : 0;
}

Ns RecallingClock::post(std::uint32_t i, std::size_t frame) {
  Thread& t = threads_[i];
  const CompiledFrame& program = t.task->frame(frame + scene_->offset);
  if (t.task->device != kNone) used_.device_bytes[t.task->device] += program.device_bytes;
  used_.node_bytes[t.task->node] += program.node_bytes;
  if (t.running) {
    Group& group = groups_[t.group];
    const Moment::Finish& finish = moments_.finish(*group.moment);
    add(finish.held);
    t.queue_end = group.since + finish.queue_end;
    t.running = false;
    group.since += finish.time;
    group.moment = finish.after;
    std::erase(group.running, i);
    moved_ = moved_ || !group.running.empty();
    set_bounds(group);
  }
  messages_.post(i, frame, t.clock);
  return t.clock;
}

Ns RecallingClock::horizon() const {
  Ns latest = 0;
  for (const Thread& t : threads_) latest = std::max({latest, t.clock, t.queue_end});
  return latest;
}

Consumption RecallingClock::consumption() const {
  Consumption used;
  add_consumption(used, 1);
  used.makespan = horizon();
  return used;
}

void RecallingClock::add_consumption(Consumption& sum, std::size_t times) const {
  partition::add(sum, used_, times);
  partition::add(sum.link_bytes, messages_.link_bytes(), times);
}

void RecallingClock::consume(const Consumption& more, std::size_t times) {
  partition::add(used_, more, times);
}

bool RecallingClock::idle(Ns at) const {
  return messages_.idle(at) &&
         std::all_of(threads_.begin(), threads_.end(),
                     [&](const Thread& t) {
                       return !t.running && !t.alone && t.clock <= at && t.queue_end <= at;
                     }) &&
         std::all_of(groups_.begin(), groups_.end(),
                     [&](const Group& group) { return over(group, at); });
}

void RecallingClock::save(Ns at, std::size_t first, std::size_t last,
                          std::vector<Ns>& words) const {
  for (const Thread& t : threads_) {
    words.insert(words.end(), {t.clock == kLater ? kLater : t.clock - at,
                               t.queue_end > at ? t.queue_end - at : 0, t.running, t.alone});
  }
  for (const Group& group : groups_) {
    const bool idle = over(group, at);
    const Moment* moment = idle ? moments_.idle() : group.moment;
    words.insert(words.end(), {reinterpret_cast<std::uintptr_t>(moment),
                               idle ? 0 : group.since - at, !idle && group.bound});
    for (const std::uint32_t task : group.running) {
      words.insert(words.end(), {task, threads_[task].earliest - at});
    }
  }
  messages_.save(at, first, last, words);
}

void RecallingClock::forward(Ns time, std::size_t frames, std::size_t first, std::size_t last) {
  for (Thread& t : threads_) {
    if (t.clock != kLater) t.clock += time;
    t.queue_end += time;
    t.earliest += time;
  }
  for (Group& group : groups_) group.since += time;
  messages_.forward(time, frames, first, last);
}

}  // namespace partita::partition
