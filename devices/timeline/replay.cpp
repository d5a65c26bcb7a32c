// Replay: runs a record through a fresh Timeline, always the thread with the smallest virtual time
// next. What a thread refers to and does not exist yet blocks it, as it blocked the real program.
#include <algorithm>
#include <numeric>
#include <set>
#include <tuple>

#include "devices/timeline/schedule.h"

namespace partita::timeline {
namespace {

std::uint64_t mix(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 29);
}

/// What a thread does, in terms that do not depend on the order in which threads were recorded.
std::uint64_t signature(const Record& record, const RecordedThread& thread) {
  std::uint64_t hash = mix(thread.node, static_cast<std::uint64_t>(thread.at));
  for (const Action& action : thread.actions) {
    hash = mix(hash, static_cast<std::uint64_t>(action.type));
    if (action.type == ActionType::command) {
      const RecordedCommand& c = record.commands[action.arg];
      for (const char letter : record.names[c.name])
        hash = mix(hash, static_cast<unsigned char>(letter));
      for (const std::uint64_t word :
           {static_cast<std::uint64_t>(c.kind), c.demand.launch_ns, c.demand.compute_ns,
            c.demand.memory_ns, c.demand.bytes, c.bytes, static_cast<std::uint64_t>(c.frame)}) {
        hash = mix(hash, word);
      }
    } else if (action.type == ActionType::wait_until) {
      hash = mix(hash, action.value);
    }
  }
  return hash;
}

class Replay {
 public:
  explicit Replay(const Record& record)
      : record_(record),
        timeline_(record.layout, {.record = false, .occupations = &occupations_}),
        nodes_(record.commands.size(), kNone),
        waiting_(record.commands.size()) {
    for (const auto& name : record.names) timeline_.intern(name);
    for (const auto& q : record.queues) timeline_.add_queue(q.device, q.out_of_order);
    prepare_threads();
  }

  Schedule run() {
    while (!runnable_.empty()) {
      const std::uint32_t place = runnable_.begin()->second;
      runnable_.erase(runnable_.begin());
      step(place);
    }
    for (const Player& player : players_) {
      if (player.next < player.thread->actions.size()) stuck(player);
    }
    return schedule();
  }

 private:
  struct Player {
    const RecordedThread* thread;
    std::size_t next = 0;
    ThreadId id = kNone;
  };

  void prepare_threads() {
    std::vector<std::uint32_t> order(record_.threads.size());
    std::iota(order.begin(), order.end(), 0u);
    std::vector<std::uint64_t> signatures;
    for (const auto& t : record_.threads) signatures.push_back(signature(record_, t));
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const RecordedThread &x = record_.threads[a], &y = record_.threads[b];
      return std::tie(x.rank, x.name, x.start, signatures[a], a) <
             std::tie(y.rank, y.name, y.start, signatures[b], b);
    });
    for (std::uint32_t place = 0; place < order.size(); ++place) {
      const RecordedThread& thread = record_.threads[order[place]];
      players_.push_back({&thread, 0, kNone});
      if (thread.after == kNone) {
        players_[place].id = timeline_.add_thread_at(thread.name, thread.node, thread.start);
        runnable_.emplace(thread.start, place);
      } else {
        waiting_[thread.after].push_back(place);
      }
    }
  }

  /// A callback whose command has its times gets its thread; false while it has not.
  bool started(Player& player) {
    if (player.id != kNone) return true;
    const NodeId node = nodes_[player.thread->after];
    if (node == kNone || !timeline_.resolved(node)) return false;
    player.id = timeline_.begin_callback(node, player.thread->at);
    return true;
  }

  void step(std::uint32_t place) {
    Player& player = players_[place];
    if (player.id == kNone && !started(player)) {
      blocked_.push_back(place);
      return;
    }
    if (player.next == player.thread->actions.size()) return;
    const Action& action = player.thread->actions[player.next];
    const std::uint32_t missing = missing_command(action);
    if (missing != kNone) {
      waiting_[missing].push_back(place);
      return;
    }
    if (!act(player, action)) {
      blocked_.push_back(place);
      return;
    }
    ++player.next;
    runnable_.emplace(timeline_.clock(player.id), place);
    if (action.type == ActionType::command) wake(waiting_[action.arg]);
    if (action.type == ActionType::set_event) wake(blocked_);
  }

  void wake(std::vector<std::uint32_t>& places) {
    const std::vector<std::uint32_t> woken = std::move(places);
    places.clear();
    for (const std::uint32_t place : woken) {
      Player& player = players_[place];
      const bool running = player.id != kNone || started(player);
      if (running) runnable_.emplace(timeline_.clock(player.id), place);
      if (!running) blocked_.push_back(place);
    }
  }

  /// The first command that the action refers to and that has not been enqueued yet.
  std::uint32_t missing_command(const Action& action) const {
    std::uint32_t first = action.arg, count = 0;
    if (action.type == ActionType::command) {
      first = record_.commands[action.arg].first_wait;
      count = record_.commands[action.arg].wait_count;
    } else if (action.type == ActionType::wait) {
      count = static_cast<std::uint32_t>(action.value);
    } else if (action.type == ActionType::observe || action.type == ActionType::set_event) {
      return nodes_[action.arg] == kNone ? action.arg : kNone;
    }
    for (std::uint32_t i = first; i < first + count; ++i) {
      if (nodes_[record_.waits[i]] == kNone) return record_.waits[i];
    }
    return kNone;
  }

  std::span<const NodeId> nodes_of(std::uint32_t first, std::uint32_t count) {
    scratch_.clear();
    for (std::uint32_t i = first; i < first + count; ++i) {
      scratch_.push_back(nodes_[record_.waits[i]]);
    }
    return scratch_;
  }

  /// False if it has to wait for a user event.
  bool act(Player& player, const Action& action) {
    switch (action.type) {
      case ActionType::command:
        return enqueue(player, action.arg);
      case ActionType::wait:
        return timeline_.wait(player.id,
                              nodes_of(action.arg, static_cast<std::uint32_t>(action.value)));
      case ActionType::finish:
        return timeline_.finish(player.id, action.arg);
      case ActionType::observe:
        return timeline_.observe(player.id, nodes_[action.arg]);
      case ActionType::wait_until:
        timeline_.wait_until(player.id, action.value);
        return true;
      case ActionType::set_event:
        timeline_.set_user_event(
            player.id, nodes_[action.arg],
            static_cast<std::int32_t>(-static_cast<std::int64_t>(action.value)));
        return true;
    }
    return true;
  }

  bool enqueue(Player& player, std::uint32_t index) {
    const RecordedCommand& c = record_.commands[index];
    NodeId& node = nodes_[index];
    if (c.kind == CommandKind::user_event) {
      node = timeline_.create_user_event(player.id);
    } else if (c.kind == CommandKind::host_step) {
      node = timeline_.host_step(player.id, c.name, c.demand);
    } else if (c.kind == CommandKind::sensor_input) {
      timeline_.set_label(player.id, c.task, c.frame);
      node = timeline_.sensor_input(player.id, c.name, c.bytes);
    } else if (c.kind == CommandKind::message) {
      const NodeId post = nodes_[record_.waits[c.first_wait]];
      if (!timeline_.resolved(post)) return false;
      node = timeline_.message(player.id, c.name, post, c.bytes);
    } else {
      auto waits = nodes_of(c.first_wait, c.wait_count);
      // A list whose commands were all done before the record began is still a list.
      if (c.has_list && waits.empty()) waits = {&past(player), 1};
      node = timeline_.enqueue(player.id, {c.queue, c.kind, c.name, waits, c.demand, c.bytes,
                                           c.compute_units, nullptr, c.launch});
    }
    return true;
  }

  /// An event that is complete from time 0 on.
  const NodeId& past(Player& player) {
    if (past_ == kNone) {
      const ThreadId zero = timeline_.add_thread_at("past", player.thread->node, 0);
      past_ = timeline_.create_user_event(zero);
      timeline_.set_user_event(zero, past_, 0);
      timeline_.remove_thread(zero);
    }
    return past_;
  }

  [[noreturn]] void stuck(const Player& player) const {
    throw profile::Error("record: thread '" + player.thread->name +
                         "' cannot go on at its action " + std::to_string(player.next) +
                         ", expected what it waits for to happen");
  }

  Schedule schedule() {
    Schedule schedule;
    std::vector<std::uint32_t> command_of;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
      ScheduledCommand c;
      c.command = i;
      c.resolved = nodes_[i] != kNone && timeline_.resolved(nodes_[i]);
      if (c.resolved) {
        c.times = timeline_.times(nodes_[i]);
        c.status = timeline_.status(nodes_[i]);
      }
      if (nodes_[i] != kNone) {
        if (nodes_[i] >= command_of.size()) command_of.resize(nodes_[i] + 1, kNone);
        command_of[nodes_[i]] = i;
      }
      schedule.commands.push_back(c);
    }
    for (Occupation o : occupations_) {
      o.node = command_of[o.node];
      EngineId& first = schedule.commands[o.node].engine;
      if (first == kNone) first = o.engine;
      schedule.occupations.push_back(o);
    }
    std::sort(schedule.occupations.begin(), schedule.occupations.end(),
              [](const Occupation& a, const Occupation& b) {
                return std::tie(a.start, a.engine) < std::tie(b.start, b.engine);
              });
    schedule.engines = timeline_.engines();
    schedule.makespan = timeline_.horizon();
    return schedule;
  }

  const Record& record_;
  std::vector<Occupation> occupations_;
  Timeline timeline_;
  std::vector<NodeId> nodes_;                        ///< of the timeline, by recorded command
  std::vector<std::vector<std::uint32_t>> waiting_;  ///< players, by the command they wait to exist
  std::vector<std::uint32_t> blocked_;               ///< players that wait for a user event
  std::vector<Player> players_;                      ///< in the order that breaks ties
  std::set<std::pair<Ns, std::uint32_t>> runnable_;
  std::vector<NodeId> scratch_;
  NodeId past_ = kNone;
};

}  // namespace

Schedule replay(const Record& record) {
  return Replay(record).run();
}

std::vector<double> Schedule::utilisation() const {
  std::vector<double> share(engines.size(), 0.0);
  for (const Occupation& o : occupations) share[o.engine] += static_cast<double>(o.end - o.start);
  for (double& s : share) s = makespan > 0 ? s / static_cast<double>(makespan) : 0;
  return share;
}

}  // namespace partita::timeline
