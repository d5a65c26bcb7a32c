// Timeline: the predicted clock. It is told what a program does, call by call, and places every
// command on the machine's engines in virtual time, at once and for good:
//
//   QUEUED = H + cost of the call        (H: the calling thread's host clock)
//   SUBMIT = QUEUED + submission cost
//   READY  = max(SUBMIT, END of the wait list, END of the in-order predecessor, last barrier)
//   START  = first gap of the engine from READY on that holds the duration
//   END    = START + duration, longer where earlier commands already use the shared memory
//
// Commands that depend on an unset user event stay pending and are placed, in the order in which
// they were enqueued, when it is set. docs/predicted-clock.md has the whole story.
//
// NOT thread-safe: the caller holds one lock around every call (the layer has one anyway). A call
// costs some hundreds of nanoseconds and allocates only when storage grows.
//
// Every broken invariant (QUEUED <= SUBMIT <= START <= END, START before a dependency's END, an
// engine used twice at once, a placed command placed again) throws std::logic_error, in release
// builds too. Ids that do not exist throw profile::Error.
#ifndef PARTITA_DEVICES_TIMELINE_TIMELINE_H
#define PARTITA_DEVICES_TIMELINE_TIMELINE_H

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "devices/timeline/command.h"
#include "devices/timeline/record.h"

namespace partita::timeline {

/// An engine busy with a part of a command; what utilisation, energy and traces are made of.
struct Occupation {
  NodeId node = kNone;
  EngineId engine = kNone;
  Ns start = 0, end = 0;
};

struct Options {
  /// Keep the graph for replay: about 200 bytes a command. Off: a node's slot is used again once
  /// it is resolved and released.
  bool record = true;
  std::uint64_t record_limit = 4'000'000;  ///< commands; beyond, the record is marked incomplete
  std::vector<Occupation>* occupations = nullptr;  ///< filled as commands are placed, if given
};

class Timeline {
 public:
  explicit Timeline(Layout layout, Options options = {});
  ~Timeline();
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  const Layout& layout() const;
  /// The same id for the same text; kernels and tasks are named once and enqueued often.
  NameId intern(std::string_view text);

  // ---- Host threads -----------------------------------------------------------------------------
  /// A thread that the layer sees for the first time: on the main node, at the largest clock so
  /// far.
  ThreadId add_thread(std::string_view name);
  /// A thread on `node` whose clock starts at `clock`, as a replay has it.
  ThreadId add_thread_at(std::string_view name, std::uint32_t node, Ns clock);
  /// Names, ranks and places a thread (`near` kNone: main node); its clock becomes 0. The first
  /// binding of a timeline starts a new epoch: what happened before (building, warming up) leaves
  /// the record and frees its engines; old commands keep the times they showed, and a command that
  /// waits for one finds it long done.
  void bind_thread(ThreadId thread, std::string_view name, std::uint32_t rank, DeviceId near);
  /// Task and frame of the thread's following commands; frame -1: none.
  void set_label(ThreadId thread, NameId task, std::int64_t frame);
  Ns clock(ThreadId thread) const;
  /// The thread has ended; its slot may be used again.
  void remove_thread(ThreadId thread);

  /// A callback of `node` is about to run: a thread of its own whose clock is that time of the
  /// node (node resolved, else Error). end_callback when it returns.
  ThreadId begin_callback(NodeId node, CallbackAt at);
  void end_callback(ThreadId thread);

  // ---- Queues and commands ----------------------------------------------------------------------
  QueueId add_queue(DeviceId device, bool out_of_order);
  /// No further command will be enqueued on it.
  void remove_queue(QueueId queue);

  /// Places the command, or leaves it pending. The caller owns one reference to the node.
  NodeId enqueue(ThreadId thread, const Command& command);
  void retain(NodeId node);
  void release(NodeId node);

  /// A user event belongs to no queue. The caller owns one reference.
  NodeId create_user_event(ThreadId thread);
  /// CL_COMPLETE (0) completes it at the thread's clock; a negative status also terminates every
  /// command that waits for it by list: those take no engine, END = READY. Call it BEFORE the
  /// driver's clSetUserEventStatus, so that a wait that returns finds its commands placed. The
  /// second setting of an event is refused (false), as OpenCL does.
  bool set_user_event(ThreadId thread, NodeId node, std::int32_t status);

  /// Whether the node has its times (else it waits for a user event).
  bool resolved(NodeId node) const;
  /// 0, or the negative status that it was terminated with.
  std::int32_t status(NodeId node) const;
  /// Times of a resolved node; throws Error for a pending one.
  Times times(NodeId node) const;

  // ---- What a host thread waits for -------------------------------------------------------------
  // A blocking call costs one API call; if END is later than H, H becomes END + wake-up cost.
  // They return false, and change nothing, if something is still pending: call them when the
  // driver's own call has returned.
  bool wait(ThreadId thread, std::span<const NodeId> nodes);
  bool finish(ThreadId thread, QueueId queue);
  /// The thread saw CL_COMPLETE, or a time, of the node: H = max(H, END). Costs nothing (polling
  /// must not make the clock depend on how often it polled).
  bool observe(ThreadId thread, NodeId node);
  void wait_until(ThreadId thread, Ns time);

  /// A declared host step: a core of the thread's node, from H on; H becomes its END. Owned as a
  /// command is.
  NodeId host_step(ThreadId thread, NameId name, const Demand& demand, const Work* work = nullptr);
  /// Bytes from the sensors' node to the thread's node, sent from the time that the thread last
  /// waited for (the trigger), be it busy then or not; the thread waits for them. What one frame
  /// calls by one name travels to a node once: a second thread waits for the same arrival.
  NodeId sensor_input(ThreadId thread, NameId name, std::uint64_t bytes);
  /// What another thread posted by completing the user event `post` travels from that thread's node
  /// to this one's, from then on, be this thread busy or not; the thread waits for it. One name of
  /// one post travels to a node once. On one node nothing travels, but a thread that has to sleep
  /// for it pays for waking up. Throws Error unless `post` is a completed user event.
  NodeId message(ThreadId thread, NameId name, NodeId post, std::uint64_t bytes);

  // ---- What came of it --------------------------------------------------------------------------
  /// Wall-clock start and end of the command as executed here (ns), for predicted against measured.
  void set_measured(NodeId node, std::uint64_t start, std::uint64_t end);
  /// The largest END or host clock so far.
  Ns horizon() const;
  std::vector<Engine> engines() const;
  /// A copy of everything recorded in this epoch. Throws Error if recording is off.
  Record snapshot() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace partita::timeline

#endif  // PARTITA_DEVICES_TIMELINE_TIMELINE_H
