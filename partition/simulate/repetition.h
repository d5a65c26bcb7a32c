// Repetition: leaves out what a simulation would do again. Tasks that run on every k-th frame and
// the frames of a recorded run repeat with a cycle of frames. Where the state of everything is that
// of one or more whole cycles before, in times and frames since then, the future is the same too:
// the frames between come again as often as they fit into the simulation, and it goes on behind
// them with its clocks set forward. Inside the partitioner only.
//
// A Clock has for it, besides what Driver wants, with frames [first, last) in work and all others
// over or not begun:
//   bool idle(at)                        nothing is held, and nobody at work, from `at` on
//   void save(at, first, last, words)    appends all that matters from `at` on
//   void forward(time, frames, first, last)   everything happened so much later
//   Consumption consumption(), void consume(more, times)
#ifndef PARTITA_PARTITION_SIMULATE_REPETITION_H
#define PARTITA_PARTITION_SIMULATE_REPETITION_H

#include <algorithm>
#include <span>

#include "partition/simulate/figures.h"

namespace partita::partition {

class Repetition {
 public:
  /// `cycle`: frames; 0: nothing repeats.
  Repetition(const Scene& scene, std::size_t cycle)
      : scene_(scene), cycle_(cycle), start_(cycle == 0 ? 0 : start_of(scene, cycle)) {
    next_ = cycle == 0 ? Trace::kNot : start_ * period();
  }

  /// When every clock has come so far, look() is due.
  Ns due() const { return next_; }

  template <typename Clock>
  void look(std::vector<Actor>& actors, Clock& clock, Trace& trace) {
    Mark now;
    now.frame = next_ / period();
    if (!find_window(actors, now.frame)) return stop();
    save(actors, clock, trace, now);
    if (before_.frame > 0 && now.words == before_.words) {
      const std::size_t length = now.frame - before_.frame;
      const std::size_t times = (scene_.frames - 1 - last_) / length;
      if (times > 0) go_forward(actors, clock, trace, now, length, times);
      return stop();
    }
    // Brent: compared is with cycle 0, 1, 2, 4, …, so that one state has to be kept. The longer
    // nothing has come again, the less often it is looked for.
    const std::size_t cycles = cycles_at(now.frame);
    if (before_.frame == 0 || cycles >= 2 * cycles_at(before_.frame)) before_ = std::move(now);
    next_ += std::max<std::size_t>(1, cycles / 8) * cycle_ * period();
  }

 private:
  /// When a frame is triggered. An idle machine has no words.
  struct Mark {
    std::size_t frame = 0;  ///< 0: nothing yet
    std::vector<Ns> words;
    Consumption used;
    std::vector<std::size_t> dropped;  ///< by task
  };

  /// Frames in work at once. Where more wait, queues grow, and nothing comes again.
  static constexpr std::size_t kWidest = 64;

  /// The first frame at which to look. Whole cycles behind it, as few frames are left of the
  /// simulation as tasks that run on every k-th one only may be ahead.
  static std::size_t start_of(const Scene& scene, std::size_t cycle) {
    std::size_t ahead = 1;
    for (const PipelineTask& task : scene.pipeline->tasks) {
      ahead = std::max<std::size_t>(ahead, task.every);
    }
    const std::size_t start = scene.frames > ahead ? (scene.frames - 1 - ahead) % cycle : 0;
    return start > 0 ? start : cycle;
  }
  std::size_t cycles_at(std::size_t frame) const { return (frame - start_) / cycle_; }
  Ns period() const { return scene_.pipeline->period_ns; }
  void stop() { next_ = Trace::kNot; }
  static bool at_work(const Actor& actor) { return actor.stage != Actor::Stage::take; }

  /// Of the frames that tasks are at. False if one of them has come to the end, or they are many.
  bool find_window(const std::vector<Actor>& actors, std::size_t frame) {
    first_ = frame;
    last_ = 0;
    for (const Actor& actor : actors) {
      if (actor.state == Actor::State::done) return false;
      first_ = std::min(first_, at_work(actor) ? actor.frame : actor.next);
      for (const std::size_t waiting : actor.queue) first_ = std::min(first_, waiting);
      last_ = std::max(last_, actor.next);
    }
    return last_ < scene_.frames && last_ - first_ <= kWidest;
  }

  template <typename Clock>
  void save(const std::vector<Actor>& actors, const Clock& clock, const Trace& trace,
            Mark& mark) const {
    const Ns at = mark.frame * period();
    mark.used = clock.consumption();
    for (const Trace::Task& task : trace.tasks) mark.dropped.push_back(task.dropped);
    const bool idle = first_ == mark.frame && clock.idle(at) &&
                      std::all_of(actors.begin(), actors.end(),
                                  [](const Actor& actor) { return actor.queue.empty(); });
    if (idle) return;
    std::vector<Ns>& words = mark.words;
    for (const Actor& a : actors) {
      words.insert(words.end(), {static_cast<Ns>(a.state), static_cast<Ns>(a.stage),
                                 a.next - mark.frame, at_work(a) ? a.frame - mark.frame : 0,
                                 a.decided - mark.frame, a.input, a.any, a.op, a.queue.size()});
      for (const std::size_t waiting : a.queue) words.push_back(waiting - mark.frame);
    }
    words.insert(words.end(), {first_ - mark.frame, last_ - mark.frame});
    for (const Trace::Task& task : trace.tasks) {
      for (const auto* times : {&task.end, &task.gone}) {
        for (std::size_t k = first_; k < last_; ++k) {
          words.push_back((*times)[k] == Trace::kNot ? Trace::kNot : (*times)[k] - at);
        }
      }
    }
    clock.save(at, first_, last_, words);
  }

  template <typename Clock>
  void go_forward(std::vector<Actor>& actors, Clock& clock, Trace& trace, const Mark& now,
                  std::size_t length, std::size_t times) {
    const std::size_t frames = length * times;
    for (std::size_t i = 0; i < trace.tasks.size(); ++i) {
      Trace::Task& task = trace.tasks[i];
      for (auto* all : {&task.start, &task.end, &task.gone}) repeat(*all, length, frames);
      task.dropped += times * (task.dropped - before_.dropped[i]);
    }
    for (Actor& actor : actors) {
      actor.next += frames;
      actor.frame += frames;
      actor.decided += frames;
      for (std::size_t& waiting : actor.queue) waiting += frames;
    }
    clock.forward(frames * period(), frames, first_, last_);
    clock.consume(difference(now.used, before_.used), times);
  }

  /// What was over is repeated, what is in work is set forward.
  void repeat(std::vector<Ns>& all, std::size_t length, std::size_t frames) const {
    const auto later = [](Ns time, Ns by) { return time == Trace::kNot ? time : time + by; };
    const std::vector<Ns> in_work(all.begin() + static_cast<std::ptrdiff_t>(first_),
                                  all.begin() + static_cast<std::ptrdiff_t>(last_));
    for (std::size_t k = first_; k < first_ + frames; ++k) {
      all[k] = later(all[k - length], length * period());
    }
    for (std::size_t k = 0; k < in_work.size(); ++k) {
      all[first_ + frames + k] = later(in_work[k], frames * period());
    }
  }

  const Scene& scene_;
  std::size_t cycle_;
  std::size_t start_;
  Ns next_;
  Mark before_;
  std::size_t first_ = 0, last_ = 0;  ///< frames in work
};

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_REPETITION_H
