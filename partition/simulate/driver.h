// Driver: lets the tasks of a pipeline act in the order of virtual time on a Clock, which is the
// real Timeline (reference.cpp) or its compiled form (compiled_clock.h). What a task does, and when
// it may, is decided here once for both. Inside the partitioner only.
//
// A Clock has, for task i:
//   Ns now(i)                        its host thread's clock
//   void wait_until(i, time)
//   void sensor(i, frame)            what the sensors send of a frame arrives
//   Ns wakeup_ns(i)                  what it costs to be woken by another thread
//   void message(i, input, frame)    what its input number `input` says of a frame arrives
//   void load(i)                     its bitstream is loaded, by a command of its queue
//   size_t steps(i, frame, program, first, until)
//                                    operation `first` of its program and, as long as its clock is
//                                    below `until` or nobody can notice, more; returns how many
//   Ns post(i, frame)                what it made of a frame is there, now
//   bool moved_others()              steps() or post() has changed clocks of other tasks since
//   kLooksAhead                      steps() does the last operation when the turn after it has
//   come
#ifndef PARTITA_PARTITION_SIMULATE_DRIVER_H
#define PARTITA_PARTITION_SIMULATE_DRIVER_H

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "partition/simulate/actor.h"

namespace partita::partition {

/// What passes between tasks, or from the sensors to them: sent to a node once, whoever wants it.
struct Channel {
  std::uint32_t from = kNone;  ///< task; kNone: the sensors
  std::string name;
  std::uint64_t bytes = 0;  ///< a frame
};
struct Channels {
  std::vector<Channel> all;
  std::vector<std::vector<std::uint32_t>> inputs;  ///< by task and input: index into `all`
  std::vector<std::uint32_t> sensors;              ///< by task: the same; kNone: not fed by sensors
  std::vector<std::vector<std::uint32_t>> consumers;  ///< by task: the tasks that it feeds
};

/// What a simulation needs to know of a placement, besides the compiled tasks.
struct Scene {
  const Pipeline* pipeline = nullptr;
  const Channels* channels = nullptr;
  std::size_t frames = 0;
  std::size_t offset = 0;  ///< frame 0 counts as this one where tasks run on every k-th frame only
  std::vector<const CompiledTask*> tasks;  ///< by task of the pipeline
  std::vector<bool> swaps;                 ///< by device: tasks take turns with their bitstreams

  bool runs(std::uint32_t task, std::size_t frame) const {
    const std::uint32_t every = pipeline->tasks[task].every;
    return every == 1 || static_cast<std::uint32_t>(frame + offset) % every == 0;
  }
};

/// Simulates everything.
struct NoRepeats {
  static constexpr Ns due() { return Trace::kNot; }
  template <typename Clock>
  static void look(std::vector<Actor>&, Clock&, Trace&) {}
};

template <typename Clock, typename Repeats = NoRepeats>
class Driver {
 public:
  /// `Repeats` may leave out what comes again: see repetition.h.
  Driver(const Scene& scene, Clock& clock, Trace& trace, Repeats* repeats = nullptr)
      : scene_(scene),
        clock_(clock),
        trace_(trace),
        repeats_(repeats),
        tasks_(scene.pipeline->tasks) {}

  /// From the start, on a clock that has been reset. May be called again.
  void run() {
    reset();
    for (std::uint32_t i = pick(); i != kNone; i = pick()) {
      if (clock_.now(i) >= due()) repeats_->look(actors_, clock_, trace_);
      Actor& actor = actors_[i];
      do {
        act(i, actor);
      } while (actor.state == State::ready && goes_on(i));
    }
    for (const Actor& actor : actors_) {
      if (actor.state != State::done) throw std::logic_error("simulator: tasks wait in a circle");
    }
  }

 private:
  using State = Actor::State;
  using Stage = Actor::Stage;
  enum class Message : std::uint8_t { not_due, undecided, dropped, there };

  /// Whose bitstream an FPGA has.
  struct Turn {
    std::uint32_t holder = kNone, last = kNone;
    Ns released = 0;
  };

  void reset() {
    actors_.resize(tasks_.size());
    turns_.assign(scene_.swaps.size(), {});
    trace_.tasks.resize(tasks_.size());
    for (std::uint32_t i = 0; i < tasks_.size(); ++i) {
      Actor& actor = actors_[i];
      actor.reset();
      while (actor.next < scene_.frames && !scene_.runs(i, actor.next)) ++actor.next;
      Trace::Task& task = trace_.tasks[i];
      for (auto* times : {&task.start, &task.end, &task.gone}) {
        times->assign(scene_.frames, Trace::kNot);
      }
      task.dropped = 0;
    }
  }

  /// The ready task with the smallest clock, the first of equal ones; kNone: none is left. Without
  /// branches, since nobody can foretell them: with all bits set, a clock is kNot.
  std::uint32_t pick() {
    std::uint32_t first = kNone, second = kNone;
    Ns least = Trace::kNot, next = Trace::kNot;
    const auto count = static_cast<std::uint32_t>(actors_.size());
    for (std::uint32_t i = 0; i < count; ++i) {
      const Ns now = clock_.now(i) | (Ns{0} - Ns{actors_[i].state != State::ready});
      const bool is_first = now < least, is_second = now < next;
      next = is_first ? least : is_second ? now : next;
      second = is_first ? first : is_second ? i : second;
      least = is_first ? now : least;
      first = is_first ? i : first;
    }
    woken_ = false;
    others_ = next;
    other_ = second;
    return first;
  }

  /// Whether it is still the turn of task i.
  bool goes_on(std::uint32_t i) const { return clock_.now(i) < until(i); }
  /// Below this clock it is the turn of task i.
  Ns until(std::uint32_t i) const {
    if (woken_) return 0;
    return std::min(due(), others_ + (i < other_ && others_ != Trace::kNot ? 1 : 0));
  }
  Ns due() const { return repeats_ != nullptr ? repeats_->due() : Trace::kNot; }

  void act(std::uint32_t i, Actor& actor) {
    switch (actor.stage) {
      case Stage::take:
        return tasks_[i].when_full == WhenFull::keep ? take_next(i, actor) : take_waiting(i, actor);
      case Stage::trigger:
        clock_.wait_until(i, arrival(actor.frame));
        actor.stage = tasks_[i].inputs.empty() ? Stage::sense : Stage::turn;
        return;
      case Stage::sense:
        clock_.sensor(i, actor.frame);
        actor.stage = Stage::turn;
        return;
      case Stage::inputs:
        return receive(i, actor);
      case Stage::turn:
        begin(i, actor);
        if (actor.state != State::ready || !goes_on(i)) return;
        [[fallthrough]];
      case Stage::steps:
        if (actor.op == actor.program->ops.size()) return post(i, actor);
        actor.op += clock_.steps(i, actor.frame, *actor.program, actor.op, until(i));
        // Of a clock that looks ahead, a program is over when its turn to be over has come.
        if (Clock::kLooksAhead && actor.op == actor.program->ops.size()) post(i, actor);
        if (clock_.moved_others()) woken_ = true;
        return;
    }
  }

  Ns arrival(std::size_t frame) const { return frame * scene_.pipeline->period_ns; }

  /// Whether any producer of task i's inputs runs on the frame; if not, the trigger starts it.
  bool due(std::uint32_t i, std::size_t frame) const {
    const auto& inputs = tasks_[i].inputs;
    return std::any_of(inputs.begin(), inputs.end(),
                       [&](const Input& input) { return scene_.runs(input.task, frame); });
  }

  Message message(const Input& input, std::size_t frame) const {
    if (!scene_.runs(input.task, frame)) return Message::not_due;
    if (actors_[input.task].decided <= frame) return Message::undecided;
    return trace_.tasks[input.task].end[frame] == Trace::kNot ? Message::dropped : Message::there;
  }

  // ---- Which frame is next ----------------------------------------------------------------------

  void take_next(std::uint32_t i, Actor& actor) {
    if (actor.next >= scene_.frames) return finish(i, actor);
    actor.frame = actor.next;
    actor.next += tasks_[i].every;
    start(i, actor);
  }

  /// With a bounded queue: what came while the task was busy has gone through the queue; the one at
  /// its front is next, or else whatever comes first.
  void take_waiting(std::uint32_t i, Actor& actor) {
    const Ns now = clock_.now(i);
    Ready ready;
    while (actor.next < scene_.frames) {
      ready = when_ready(i, actor.next);
      if (!ready.known || !ready.any || ready.time > now) break;
      arrive(i, actor);
    }
    if (!actor.queue.empty()) {
      actor.frame = actor.queue.front();
      actor.queue.erase(actor.queue.begin());
      return start(i, actor);
    }
    if (actor.next >= scene_.frames) return finish(i, actor);
    if (!ready.known) return block(actor);
    actor.frame = actor.next;
    actor.next += tasks_[i].every;
    const bool woken = ready.time > now && ready.any && due(i, actor.frame);
    clock_.wait_until(i, ready.time + (woken ? clock_.wakeup_ns(i) : 0));
    if (!ready.any) return skip(i, actor);
    start(i, actor);
  }

  /// When all that a frame needs is there, or was dropped; `any`: not all of it was.
  struct Ready {
    bool known = true, any = true;
    Ns time = 0;
  };
  Ready when_ready(std::uint32_t i, std::size_t frame) const {
    if (!due(i, frame)) return {true, true, arrival(frame)};
    Ready ready{true, false, 0};
    for (const Input& input : tasks_[i].inputs) {
      const Message is = message(input, frame);
      if (is == Message::undecided) return {false, false, 0};
      if (is == Message::not_due) continue;
      const Trace::Task& from = trace_.tasks[input.task];
      ready.time = std::max(ready.time, is == Message::there ? from.end[frame] : from.gone[frame]);
      ready.any = ready.any || is == Message::there;
    }
    return ready;
  }

  void arrive(std::uint32_t i, Actor& actor) {
    const std::size_t frame = actor.next;
    actor.next += tasks_[i].every;
    if (actor.queue.size() < tasks_[i].queue_depth) return actor.queue.push_back(frame);
    ++trace_.tasks[i].dropped;
    if (tasks_[i].when_full == WhenFull::drop_newest || actor.queue.empty()) return;
    actor.queue.erase(actor.queue.begin());
    actor.queue.push_back(frame);
  }

  void start(std::uint32_t i, Actor& actor) {
    decide(i, actor.frame);
    actor.input = 0;
    actor.any = false;
    actor.stage = due(i, actor.frame) ? Stage::inputs : Stage::trigger;
  }

  /// Everything that it would have needed was dropped before it.
  void skip(std::uint32_t i, Actor& actor) {
    ++trace_.tasks[i].dropped;
    decide(i, actor.frame + 1);
    actor.stage = Stage::take;
  }

  void finish(std::uint32_t i, Actor& actor) {
    decide(i, scene_.frames);
    actor.state = State::done;
  }

  // ---- What it does with it ---------------------------------------------------------------------

  /// Its inputs one after the other, in the pipeline's order. Of those that are not of this frame,
  /// or were dropped on the way, it uses the latest earlier ones, which it has; but that one was
  /// dropped it only knows when that happened.
  void receive(std::uint32_t i, Actor& actor) {
    const auto& inputs = tasks_[i].inputs;
    while (actor.input < inputs.size()) {
      const Message is = message(inputs[actor.input], actor.frame);
      if (is == Message::undecided) return block(actor);
      ++actor.input;
      if (is == Message::not_due) continue;
      if (is == Message::dropped) {
        const Trace::Task& from = trace_.tasks[inputs[actor.input - 1].task];
        return clock_.wait_until(i, from.gone[actor.frame]);
      }
      actor.any = true;
      return clock_.message(i, actor.input - 1, actor.frame);
    }
    if (!actor.any) return skip(i, actor);
    actor.stage = Stage::turn;
  }

  void begin(std::uint32_t i, Actor& actor) {
    Ns& start = trace_.tasks[i].start[actor.frame];
    if (start == Trace::kNot) start = clock_.now(i);
    const std::uint32_t device = scene_.tasks[i]->device;
    if (device != kNone && scene_.swaps[device]) {
      Turn& turn = turns_[device];
      if (turn.holder != kNone) return block(actor);
      turn.holder = i;
      clock_.wait_until(i, turn.released);
      if (turn.last != i) clock_.load(i);
      turn.last = i;
    }
    actor.program = &scene_.tasks[i]->frame(actor.frame + scene_.offset);
    actor.op = 0;
    actor.stage = Stage::steps;
  }

  void post(std::uint32_t i, Actor& actor) {
    trace_.tasks[i].end[actor.frame] = clock_.post(i, actor.frame);
    if (clock_.moved_others()) woken_ = true;
    const std::uint32_t device = scene_.tasks[i]->device;
    if (device != kNone && scene_.swaps[device]) {
      turns_[device].holder = kNone;
      turns_[device].released = clock_.now(i);
      for (std::uint32_t other = 0; other < actors_.size(); ++other) {
        if (scene_.tasks[other]->device == device) wake(actors_[other]);
      }
    }
    decide(i, actor.frame + 1);
    actor.stage = Stage::take;
  }

  void block(Actor& actor) { actor.state = State::blocked; }
  /// Lets it look again whether it can go on.
  void wake(Actor& actor) {
    if (actor.state != State::blocked) return;
    actor.state = State::ready;
    woken_ = true;
  }
  void decide(std::uint32_t i, std::size_t frames) {
    Actor& actor = actors_[i];
    if (frames <= actor.decided) return;
    Trace::Task& task = trace_.tasks[i];
    for (std::size_t k = actor.decided; k < frames; ++k) {
      if (task.end[k] == Trace::kNot) task.gone[k] = clock_.now(i);
    }
    actor.decided = frames;
    for (const std::uint32_t consumer : scene_.channels->consumers[i]) wake(actors_[consumer]);
  }

  const Scene& scene_;
  Clock& clock_;
  Trace& trace_;
  Repeats* repeats_;
  const std::vector<PipelineTask>& tasks_;
  std::vector<Actor> actors_;
  std::vector<Turn> turns_;
  Ns others_ = 0;  ///< the smallest clock of the other ready tasks, and whose it is
  std::uint32_t other_ = kNone;
  bool woken_ = false;
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_DRIVER_H
