#include "devices/timeline/timeline.h"

#include <algorithm>

#include "devices/timeline/impl.h"

namespace partita::timeline {
namespace {

constexpr std::string_view kKindNames[] = {
    "kernel", "write",   "read", "map",       "unmap",        "copy",      "fill",
    "marker", "barrier", "load", "host_step", "sensor_input", "user_event", "message"};
static_assert(std::size(kKindNames) == static_cast<std::size_t>(CommandKind::count_));

profile::Error no_such(const char* what, std::uint32_t id) {
  return profile::Error("timeline: no " + std::string(what) + " " + std::to_string(id) +
                        ", expected one that exists");
}

}  // namespace

std::string_view to_string(CommandKind kind) {
  return kind < CommandKind::count_ ? kKindNames[static_cast<std::size_t>(kind)] : "?";
}

Timeline::Impl::Impl(Layout l, Options o)
    : layout((check_layout(l), std::move(l))),
      options(o),
      placement(layout, o.occupations),
      recorder(o.record_limit) {
  intern("");
}

NameId Timeline::Impl::intern(std::string_view text) {
  const auto known = name_ids.find(text);
  if (known != name_ids.end()) return known->second;
  names.emplace_back(text);
  const auto id = static_cast<NameId>(names.size() - 1);
  name_ids.emplace(names.back(), id);
  return id;
}

Timeline::Impl::Thread& Timeline::Impl::thread(ThreadId id) {
  if (id >= threads.size() || !threads[id].live) throw no_such("thread", id);
  return threads[id];
}

Timeline::Impl::Queue& Timeline::Impl::queue(QueueId id) {
  if (id >= queues.size() || !queues[id].live) throw no_such("queue", id);
  return queues[id];
}

Timeline::Impl::Node& Timeline::Impl::node(NodeId id) {
  if (id < nodes.size() && nodes[id].state != State::free) return nodes[id];
  throw no_such("command", id);
}

ThreadId Timeline::Impl::new_thread(std::string_view name, std::uint32_t node, Ns clock) {
  if (node >= layout.nodes.size()) throw no_such("node", node);
  ThreadId id = 0;
  if (free_threads.empty()) {
    id = static_cast<ThreadId>(threads.size());
    threads.emplace_back();
  } else {
    id = free_threads.back();
    free_threads.pop_back();
    threads[id] = {};
  }
  threads[id].name = name;
  threads[id].node = node;
  advance(threads[id], clock);
  return id;
}

void Timeline::Impl::advance(Thread& thread, Ns clock) {
  if (clock > kLatest) throw profile::Error("timeline: a time beyond 36 years, expected less");
  thread.clock = std::max(thread.clock, clock);
  max_clock = std::max(max_clock, thread.clock);
  horizon = std::max(horizon, thread.clock);
}

/// The thread's place in the record; call it before the action changes the clock.
std::uint32_t Timeline::Impl::recorded(Thread& t) {
  if (t.recorded == kNone) {
    const bool callback = t.after != kNone && recorder.has(t.after);
    t.recorded = recorder.thread(
        {t.name, t.rank, t.node, t.clock, callback ? recorder.index(t.after) : kNone, t.at, {}});
  }
  return t.recorded;
}

void Timeline::Impl::new_epoch() {
  ++epoch;
  placement.clear();
  arrivals.clear();
  deliveries.clear();
  recorder.restart(static_cast<NodeId>(nodes.size()));
  free_nodes.clear();  // while recording, ids are dense
  for (Thread& t : threads) {
    t.clock = 0;
    t.trigger = kLatest;
    t.recorded = kNone;
    t.after = kNone;
  }
  for (Queue& q : queues) q.all_end = q.barrier_end = 0;
  for (auto& [id, p] : pending) {
    Node& n = node(id);
    n.times = {};
    n.epoch = epoch;
    p.ready = 0;
  }
  max_clock = horizon = 0;
}

/// A blocking call of the thread on something that ends at `end`.
void Timeline::Impl::block(Thread& t, Ns end, std::uint32_t queue_or_none) {
  const LayoutNode& node = layout.nodes[t.node];
  Ns call = node.api_call_ns, wake = node.wakeup_ns;
  if (queue_or_none != kNone) {
    const LayoutDevice& device = layout.devices[queues[queue_or_none].device];
    call = device.api_call_ns;
    wake = device.wakeup_ns + placement.latency(device.node, t.node);
  }
  advance(t, t.clock + call);
  if (end > t.clock) advance(t, end + wake);
}

Timeline::Timeline(Layout layout, Options options)
    : impl_(std::make_unique<Impl>(std::move(layout), options)) {}
Timeline::~Timeline() = default;

const Layout& Timeline::layout() const {
  return impl_->layout;
}
NameId Timeline::intern(std::string_view text) {
  return impl_->intern(text);
}

ThreadId Timeline::add_thread(std::string_view name) {
  return impl_->new_thread(name, impl_->layout.main_node, impl_->max_clock);
}

ThreadId Timeline::add_thread_at(std::string_view name, std::uint32_t node, Ns clock) {
  return impl_->new_thread(name, node, clock);
}

void Timeline::bind_thread(ThreadId id, std::string_view name, std::uint32_t rank, DeviceId near) {
  Impl::Thread& t = impl_->thread(id);
  if (near != kNone && near >= impl_->layout.devices.size()) throw no_such("device", near);
  if (!impl_->any_bound) impl_->new_epoch();
  impl_->any_bound = true;
  t.name = name;
  t.rank = rank;
  t.node = near == kNone ? impl_->layout.main_node : impl_->layout.devices[near].node;
  t.clock = 0;
  t.recorded = kNone;
  t.after = kNone;
}

void Timeline::set_label(ThreadId id, NameId task, std::int64_t frame) {
  Impl::Thread& t = impl_->thread(id);
  if (task >= impl_->names.size()) throw no_such("name", task);
  t.task = task;
  t.frame = frame;
}

Ns Timeline::clock(ThreadId id) const {
  return impl_->thread(id).clock;
}

void Timeline::remove_thread(ThreadId id) {
  impl_->thread(id).live = false;
  impl_->free_threads.push_back(id);
}

ThreadId Timeline::begin_callback(NodeId id, CallbackAt at) {
  const Times when = times(id);
  const Ns clock = impl_->node(id).epoch != impl_->epoch ? 0
                   : at == CallbackAt::submit            ? when.submit
                   : at == CallbackAt::start             ? when.start
                                                         : when.end;
  const ThreadId thread = impl_->new_thread("callback", impl_->layout.main_node, clock);
  impl_->threads[thread].after = id;
  impl_->threads[thread].at = at;
  return thread;
}

void Timeline::end_callback(ThreadId thread) {
  remove_thread(thread);
}

QueueId Timeline::add_queue(DeviceId device, bool out_of_order) {
  if (device >= impl_->layout.devices.size()) throw no_such("device", device);
  const auto id = static_cast<QueueId>(impl_->queues.size());
  impl_->queues.push_back({});
  impl_->queues.back().device = device;
  impl_->queues.back().out_of_order = out_of_order;
  impl_->recorder.queue(id, device, out_of_order);
  return id;
}

void Timeline::remove_queue(QueueId queue) {
  impl_->queue(queue).live = false;
}

NodeId Timeline::enqueue(ThreadId thread, const Command& command) {
  return impl_->enqueue(thread, command);
}
void Timeline::retain(NodeId node) {
  ++impl_->node(node).refs;
}
void Timeline::release(NodeId node) {
  impl_->drop(node);
}
NodeId Timeline::create_user_event(ThreadId thread) {
  return impl_->create_user_event(thread);
}
bool Timeline::set_user_event(ThreadId thread, NodeId node, std::int32_t status) {
  return impl_->set_user_event(thread, node, status);
}

bool Timeline::resolved(NodeId node) const {
  return impl_->node(node).state == Impl::State::resolved;
}
std::int32_t Timeline::status(NodeId node) const {
  return impl_->node(node).status;
}
Times Timeline::times(NodeId id) const {
  const Impl::Node& n = impl_->node(id);
  if (n.state != Impl::State::resolved) {
    throw profile::Error("timeline: command " + std::to_string(id) +
                         " has no times yet, expected its user event to be set first");
  }
  return n.times;
}

bool Timeline::wait(ThreadId id, std::span<const NodeId> nodes) {
  Impl::Thread& t = impl_->thread(id);
  Ns end = 0;
  for (const NodeId n : nodes) {
    if (!resolved(n)) return false;
    end = std::max(end, impl_->seen_end(impl_->node(n)));
  }
  if (nodes.empty()) return true;
  if (impl_->options.record && impl_->recorder.open()) {
    impl_->recorder.wait(impl_->recorded(t), nodes);
  }
  impl_->block(t, end, impl_->node(nodes[0]).queue);
  return true;
}

bool Timeline::finish(ThreadId id, QueueId queue) {
  Impl::Thread& t = impl_->thread(id);
  const Impl::Queue& q = impl_->queue(queue);
  if (!q.pending.empty()) return false;
  if (impl_->options.record && impl_->recorder.open()) {
    impl_->recorder.action(impl_->recorded(t), ActionType::finish, queue, 0);
  }
  impl_->block(t, q.all_end, queue);
  return true;
}

bool Timeline::observe(ThreadId id, NodeId node) {
  Impl::Thread& t = impl_->thread(id);
  if (!resolved(node)) return false;
  Recorder& recorder = impl_->recorder;
  if (impl_->options.record && recorder.open() && recorder.has(node)) {
    recorder.action(impl_->recorded(t), ActionType::observe, recorder.index(node), 0);
  }
  impl_->advance(t, impl_->seen_end(impl_->node(node)));
  return true;
}

void Timeline::wait_until(ThreadId id, Ns time) {
  Impl::Thread& t = impl_->thread(id);
  if (impl_->options.record && impl_->recorder.open()) {
    impl_->recorder.action(impl_->recorded(t), ActionType::wait_until, 0, time);
  }
  t.trigger = time;
  impl_->advance(t, time);
}

NodeId Timeline::host_step(ThreadId thread, NameId name, const Demand& demand, const Work* work) {
  return impl_->host_step(thread, name, demand, work);
}
NodeId Timeline::sensor_input(ThreadId thread, NameId name, std::uint64_t bytes) {
  return impl_->sensor_input(thread, name, bytes);
}

NodeId Timeline::message(ThreadId thread, NameId name, NodeId post, std::uint64_t bytes) {
  return impl_->message(thread, name, post, bytes);
}

void Timeline::set_measured(NodeId node, std::uint64_t start, std::uint64_t end) {
  impl_->recorder.measured(node, start, end);
}
Ns Timeline::horizon() const {
  return impl_->horizon;
}
std::vector<Engine> Timeline::engines() const {
  return impl_->placement.engines();
}

Record Timeline::snapshot() const {
  if (!impl_->options.record) {
    throw profile::Error("timeline: nothing was recorded, expected recording to be on");
  }
  Record record = impl_->recorder.copy();
  record.layout = impl_->layout;
  record.names.assign(impl_->names.begin(), impl_->names.end());
  const NodeId first = impl_->recorder.first();
  for (std::size_t i = 0; i < record.commands.size(); ++i) {
    const Impl::Node& n = impl_->node(first + static_cast<NodeId>(i));
    record.commands[i].resolved = n.state == Impl::State::resolved;
    if (record.commands[i].resolved) record.commands[i].live = n.times;
  }
  return record;
}

}  // namespace partita::timeline
