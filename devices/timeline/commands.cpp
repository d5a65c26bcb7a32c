// Commands: from an enqueue to its times. Most are placed at once; those that depend on a user
// event wait in `pending` and are placed when it is set, in the order in which they were enqueued.
#include <algorithm>
#include <queue>
#include <stdexcept>

#include "devices/timeline/impl.h"

namespace partita::timeline {
namespace {

void check(const Demand& d) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 50;
  if (d.launch_ns > kLongest || d.compute_ns > kLongest || d.memory_ns > kLongest ||
      d.bytes > kMostBytes || d.units == 0) {
    throw profile::Error(
        "timeline: a demand out of range, expected at most 2^42 ns and 2^50 bytes");
  }
}

constexpr std::int32_t kFailedInWaitList = -14;  // CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST

}  // namespace

NodeId Timeline::Impl::new_node(CommandKind kind, QueueId queue) {
  NodeId id = 0;
  if (free_nodes.empty()) {
    if (nodes.size() == kNone) throw profile::Error("timeline: 2^32 commands, expected fewer");
    id = static_cast<NodeId>(nodes.size());
    nodes.push_back({});
  } else {
    id = free_nodes.back();
    free_nodes.pop_back();
  }
  Node& n = nodes[id];
  n = {};
  n.queue = queue;
  n.refs = 2;  // the caller's, and the timeline's own until it is resolved
  n.epoch = epoch;
  n.kind = kind;
  n.state = State::pending;
  return id;
}

void Timeline::Impl::drop(NodeId id, std::uint32_t count) {
  Node& n = node(id);
  if (n.refs < count) throw std::logic_error("timeline: a command released too often");
  n.refs -= count;
  const bool kept = options.record && (recorder.open() || recorder.has(id));
  if (n.refs > 0 || kept) return;
  n.state = State::free;
  free_nodes.push_back(id);
}

void Timeline::Impl::record_command(Thread& t, NodeId id, const Command& c) {
  if (!options.record || !recorder.open()) return;
  RecordedCommand r;
  r.kind = c.kind;
  r.name = c.name;
  r.task = t.task;
  r.frame = t.frame;
  r.queue = c.queue;
  r.launch = c.launch;
  r.demand = c.demand;
  r.bytes = c.bytes;
  r.compute_units = c.compute_units;
  recorder.command(id, recorded(t), r, c.waits, c.work);
}

/// `id` has to wait for `on`: now, if that has its times, or until it has.
void Timeline::Impl::depend(NodeId on, NodeId id, bool listed, Pending& wanted) {
  const Node& n = node(on);
  if (n.state == State::pending) {
    pending.at(on).dependents.push_back({id, listed});
    ++wanted.missing;
    return;
  }
  wanted.ready = std::max(wanted.ready, seen_end(n));
  if (listed && n.status < 0) wanted.fails = true;
}

/// READY, as far as it is known, and how much is missing.
void Timeline::Impl::collect(const Command& c, NodeId id, Pending& wanted) {
  Queue& q = queues[c.queue];
  const bool marks = c.kind == CommandKind::marker || c.kind == CommandKind::barrier;
  if (!q.out_of_order) {
    wanted.ready = std::max(wanted.ready, q.all_end);
    if (!q.pending.empty()) depend(q.pending.back(), id, false, wanted);
  } else {
    wanted.ready = std::max(wanted.ready, q.barrier_end);
    if (q.pending_barrier != kNone) depend(q.pending_barrier, id, false, wanted);
    if (marks && c.waits.empty()) {
      wanted.ready = std::max(wanted.ready, q.all_end);
      for (const NodeId earlier : q.pending) depend(earlier, id, false, wanted);
    }
  }
  for (const NodeId on : c.waits) depend(on, id, true, wanted);
}

NodeId Timeline::Impl::enqueue(ThreadId thread_id, const Command& c) {
  Thread& t = thread(thread_id);
  Queue& q = queue(c.queue);
  if (c.kind >= CommandKind::host_step || c.name >= names.size()) {
    throw profile::Error("timeline: a command of kind '" + std::string(to_string(c.kind)) +
                         "', expected one that a queue takes, with an interned name");
  }
  check(c.demand);
  for (const NodeId on : c.waits) node(on);  // throws before anything has changed
  const NodeId id = new_node(c.kind, c.queue);
  record_command(t, id, c);
  const LayoutDevice& device = layout.devices[q.device];
  advance(t, t.clock + device.api_call_ns);
  Node& n = node(id);
  n.times.queued = t.clock;
  n.times.submit = t.clock + device.submit_ns;
  if (t.node != device.node) n.times.submit += placement.latency(t.node, device.node);

  Pending wanted{{c.kind, c.name, t.node, c.compute_units, c.demand, c.bytes},
                 n.times.submit,
                 orders++,
                 0,
                 false,
                 {}};
  collect(c, id, wanted);
  if (wanted.missing == 0) {
    place(id, wanted);
    drop(id);
    return id;
  }
  q.pending.push_back(id);
  if (c.kind == CommandKind::barrier) q.pending_barrier = id;
  pending.emplace(id, std::move(wanted));
  return id;
}

Placed Timeline::Impl::placed(NodeId id, const Spec& s, Ns ready) {
  const DeviceId device = queues[node(id).queue].device;
  switch (s.kind) {
    case CommandKind::kernel:
      return placement.kernel(id, device, s.name, names[s.name], s.compute_units, ready,
                              placement.prepare(device, s.demand));
    case CommandKind::write:
      return placement.transfer(id, device, s.node, true, false, ready, s.bytes);
    case CommandKind::read:
      return placement.transfer(id, device, s.node, false, false, ready, s.bytes);
    case CommandKind::map:
      return placement.transfer(id, device, s.node, false, true, ready, s.bytes);
    case CommandKind::unmap:
      return placement.transfer(id, device, s.node, true, true, ready, s.bytes);
    case CommandKind::copy:
    case CommandKind::fill:
      return placement.inside(id, device, ready, placement.prepare_inside(device, s.demand));
    case CommandKind::load:
      return placement.load(id, device, ready, s.demand);
    default:
      return {ready, ready};
  }
}

/// The command has all it waits for: its times, once and for all.
void Timeline::Impl::place(NodeId id, const Pending& p) {
  const Placed times = p.fails ? Placed{p.ready, p.ready} : placed(id, p.spec, p.ready);
  if (times.start < p.ready) throw std::logic_error("timeline: START before a dependency's END");
  settle(id, times, p.fails ? kFailedInWaitList : 0);
}

void Timeline::Impl::settle(NodeId id, const Placed& times, std::int32_t status) {
  Node& n = node(id);
  if (n.state != State::pending) throw std::logic_error("timeline: a command placed twice");
  n.times.start = times.start;
  n.times.end = times.end;
  n.status = status;
  n.state = State::resolved;
  if (n.times.queued > n.times.submit || n.times.submit > times.start || times.start > times.end) {
    throw std::logic_error("timeline: QUEUED <= SUBMIT <= START <= END does not hold");
  }
  if (times.end > kLatest) throw profile::Error("timeline: a time beyond 36 years, expected less");
  horizon = std::max(horizon, times.end);
  if (n.queue == kNone) return;
  Queue& q = queues[n.queue];
  q.all_end = std::max(q.all_end, times.end);
  if (n.kind == CommandKind::barrier) q.barrier_end = std::max(q.barrier_end, times.end);
}

/// A pending node gets its times; then those that waited for nothing else, in order.
void Timeline::Impl::resolve(NodeId first, const Placed& first_times, std::int32_t status) {
  using Entry = std::pair<std::uint64_t, NodeId>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> ready;
  settle(first, first_times, status);
  ready.emplace(0, first);
  while (!ready.empty()) {
    const NodeId id = ready.top().second;
    ready.pop();
    if (node(id).state == State::pending) place(id, pending.at(id));
    const std::vector<Edge> dependents = std::move(pending.at(id).dependents);
    pending.erase(id);
    const Node& n = node(id);
    if (n.queue != kNone) {
      Queue& q = queues[n.queue];
      q.pending.erase(std::find(q.pending.begin(), q.pending.end(), id));
      if (q.pending_barrier == id) q.pending_barrier = kNone;
    }
    for (const Edge& edge : dependents) {
      Pending& p = pending.at(edge.node);
      p.ready = std::max(p.ready, n.times.end);
      p.fails = p.fails || (edge.listed && n.status < 0);
      if (--p.missing == 0) ready.emplace(p.order, edge.node);
    }
    drop(id);
  }
}

NodeId Timeline::Impl::create_user_event(ThreadId thread_id) {
  Thread& t = thread(thread_id);
  const NodeId id = new_node(CommandKind::user_event, kNone);
  Command c;
  c.kind = CommandKind::user_event;
  record_command(t, id, c);
  node(id).times.queued = node(id).times.submit = t.clock;
  node(id).home = static_cast<std::uint8_t>(t.node);  // a layout has at most 64
  pending.emplace(id, Pending{{}, t.clock, orders++, 1, false, {}});
  return id;
}

bool Timeline::Impl::set_user_event(ThreadId thread_id, NodeId id, std::int32_t status) {
  Thread& t = thread(thread_id);
  Node& n = node(id);
  if (n.kind != CommandKind::user_event || n.state != State::pending || status > 0) return false;
  if (options.record && recorder.open() && recorder.has(id)) {
    recorder.action(recorded(t), ActionType::set_event, recorder.index(id),
                    static_cast<std::uint64_t>(-static_cast<std::int64_t>(status)));
  }
  // Another thread, whose clock is ahead, may have created it: it cannot complete before that.
  const Ns now = std::max(t.clock, n.times.submit);
  resolve(id, {now, now}, status);
  return true;
}

NodeId Timeline::Impl::host_step(ThreadId thread_id, NameId name, const Demand& demand,
                                 const Work* work) {
  Thread& t = thread(thread_id);
  if (name >= names.size()) throw profile::Error("timeline: a host step without a name");
  check(demand);
  const NodeId id = new_node(CommandKind::host_step, kNone);
  Command c;
  c.kind = CommandKind::host_step;
  c.name = name;
  c.demand = demand;
  c.work = work;
  record_command(t, id, c);
  node(id).times.queued = node(id).times.submit = t.clock;
  settle(id, placement.core(id, t.node, t.clock, placement.prepare_step(t.node, demand)), 0);
  advance(t, node(id).times.end);
  drop(id);
  return id;
}

/// The sensors send when they have data, whether or not the thread is free to receive. The same
/// data of a frame travel to a node once; who asks second waits for what is on its way.
Placed Timeline::Impl::arrival(NodeId id, const Thread& t, NameId name, std::uint64_t bytes) {
  const Ns ready = node(id).times.submit;
  if (t.frame < 0) return placement.network(id, layout.sensor_node, t.node, ready, bytes);
  const auto [entry, first] = arrivals.try_emplace({name, t.frame, t.node});
  if (first) entry->second = placement.network(id, layout.sensor_node, t.node, ready, bytes);
  const Placed& there = entry->second;
  return {std::max(there.start, ready), std::max(there.end, ready)};
}

NodeId Timeline::Impl::sensor_input(ThreadId thread_id, NameId name, std::uint64_t bytes) {
  Thread& t = thread(thread_id);
  if (name >= names.size()) throw profile::Error("timeline: a sensor input without a name");
  const NodeId id = new_node(CommandKind::sensor_input, kNone);
  Command c;
  c.kind = CommandKind::sensor_input;
  c.name = name;
  c.bytes = bytes;
  record_command(t, id, c);
  node(id).times.queued = node(id).times.submit = std::min(t.clock, t.trigger);
  settle(id, arrival(id, t, name, bytes), 0);
  const Ns end = node(id).times.end;
  if (end > t.clock) advance(t, end + layout.nodes[t.node].wakeup_ns);
  drop(id);
  return id;
}

NodeId Timeline::Impl::message(ThreadId thread_id, NameId name, NodeId post, std::uint64_t bytes) {
  Thread& t = thread(thread_id);
  if (name >= names.size()) throw profile::Error("timeline: a message without a name");
  const Node& posted_by = node(post);
  if (posted_by.kind != CommandKind::user_event || posted_by.state != State::resolved ||
      posted_by.epoch != epoch) {
    throw profile::Error("timeline: a message of command " + std::to_string(post) +
                         ", expected a user event of this epoch that is complete");
  }
  const std::uint32_t home = posted_by.home;
  const Ns posted = posted_by.times.end;
  const NodeId id = new_node(CommandKind::message, kNone);
  Command c;
  c.kind = CommandKind::message;
  c.name = name;
  c.bytes = bytes;
  c.waits = {&post, 1};
  record_command(t, id, c);
  node(id).times.queued = node(id).times.submit = std::min(t.clock, posted);
  const auto [entry, first] = deliveries.try_emplace({post, name, t.node});
  if (first) entry->second = placement.network(id, home, t.node, posted, bytes);
  settle(id, entry->second, 0);
  const Ns end = node(id).times.end;
  if (end > t.clock) advance(t, end + layout.nodes[t.node].wakeup_ns);
  drop(id);
  return id;
}

}  // namespace partita::timeline
