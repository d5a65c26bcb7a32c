// The timeline's state and its steps. Inside the timeline only; timeline.h says what they mean.
#ifndef PARTITA_DEVICES_TIMELINE_IMPL_H
#define PARTITA_DEVICES_TIMELINE_IMPL_H

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "devices/timeline/chunked.h"
#include "devices/timeline/placement.h"
#include "devices/timeline/recorder.h"
#include "devices/timeline/timeline.h"

namespace partita::timeline {

class Timeline::Impl {
 public:
  Impl(Layout layout, Options options);

  struct Thread {
    Ns clock = 0;
    std::uint32_t node = 0;
    NameId task = 0;
    std::int64_t frame = -1;
    Ns trigger = kLatest;  ///< what it last waited for: from then on its sensors have data
    std::uint32_t recorded = kNone;  ///< its place in the record, from its first action on
    std::uint32_t rank = kNone;
    NodeId after = kNone;  ///< of a callback
    CallbackAt at = CallbackAt::end;
    bool live = true;
    std::string name;
  };

  struct Queue {
    DeviceId device = 0;
    bool out_of_order = false;
    bool live = true;
    Ns all_end = 0;      ///< the latest END of its commands
    Ns barrier_end = 0;  ///< of its latest barrier
    NodeId pending_barrier = kNone;
    std::vector<NodeId> pending;  ///< in the order of enqueueing
  };

  enum class State : std::uint8_t { free, pending, resolved };
  struct Node {
    Times times;
    QueueId queue = kNone;
    std::uint32_t refs = 0;
    std::int32_t status = 0;
    std::uint16_t epoch = 0;
    CommandKind kind = CommandKind::kernel;
    State state = State::free;
    std::uint8_t home = 0;  ///< node of the thread that made a user event
  };

  /// What placing a command takes, kept while it is pending.
  struct Spec {
    CommandKind kind;
    NameId name;
    std::uint32_t node;  ///< of the thread that enqueued it
    std::uint32_t compute_units;
    Demand demand;
    std::uint64_t bytes;
  };
  struct Edge {
    NodeId node;
    bool listed;  ///< from a wait list: a failure terminates; from the queue's order: it does not
  };
  struct Pending {
    Spec spec;
    Ns ready = 0;
    std::uint64_t order = 0;
    std::uint32_t missing = 0;
    bool fails = false;
    std::vector<Edge> dependents;
  };

  // timeline.cpp
  NameId intern(std::string_view text);
  Thread& thread(ThreadId id);
  Queue& queue(QueueId id);
  Node& node(NodeId id);
  ThreadId new_thread(std::string_view name, std::uint32_t node, Ns clock);
  void advance(Thread& thread, Ns clock);
  std::uint32_t recorded(Thread& thread);
  void new_epoch();
  Ns seen_end(const Node& node) const { return node.epoch == epoch ? node.times.end : 0; }
  void block(Thread& thread, Ns end, std::uint32_t queue_or_none);

  // commands.cpp
  NodeId new_node(CommandKind kind, QueueId queue);
  void drop(NodeId id, std::uint32_t count = 1);
  NodeId enqueue(ThreadId thread, const Command& command);
  NodeId create_user_event(ThreadId thread);
  bool set_user_event(ThreadId thread, NodeId id, std::int32_t status);
  NodeId host_step(ThreadId thread, NameId name, const Demand& demand, const Work* work);
  NodeId sensor_input(ThreadId thread, NameId name, std::uint64_t bytes);
  Placed arrival(NodeId id, const Thread& thread, NameId name, std::uint64_t bytes);
  NodeId message(ThreadId thread, NameId name, NodeId post, std::uint64_t bytes);
  void record_command(Thread& thread, NodeId id, const Command& command);
  void collect(const Command& command, NodeId id, Pending& wanted);
  void depend(NodeId on, NodeId id, bool listed, Pending& wanted);
  Placed placed(NodeId id, const Spec& spec, Ns ready);
  void place(NodeId id, const Pending& command);
  void settle(NodeId id, const Placed& times, std::int32_t status);
  void resolve(NodeId id, const Placed& times, std::int32_t status);

  Layout layout;
  Options options;
  Placement placement;
  Recorder recorder;
  std::deque<std::string> names;
  std::unordered_map<std::string_view, NameId> name_ids;
  std::vector<Thread> threads;
  std::vector<ThreadId> free_threads;
  std::vector<Queue> queues;
  Chunked<Node> nodes;
  std::vector<NodeId> free_nodes;
  std::unordered_map<NodeId, Pending> pending;
  std::map<std::tuple<NameId, std::int64_t, std::uint32_t>, Placed> arrivals;  ///< frame's, at node
  std::map<std::tuple<NodeId, NameId, std::uint32_t>, Placed> deliveries;      ///< post's, at node
  std::uint64_t orders = 0;
  std::uint16_t epoch = 0;
  bool any_bound = false;
  Ns max_clock = 0;
  Ns horizon = 0;
};

}  // namespace partita::timeline

#endif  // PARTITA_DEVICES_TIMELINE_IMPL_H
