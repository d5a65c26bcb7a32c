#include "partition/simulate/moments.h"

#include <algorithm>

namespace partita::partition {
namespace {

constexpr std::size_t kMostBytes = std::size_t{64} << 20;  // for each thread of a search

std::uint64_t hash_of(const std::vector<Running>& running, const std::vector<Ns>& taken) {
  std::uint64_t hash = running.size();
  for (const Running& r : running) {
    hash = mixed(mixed(mixed(hash, r.program), r.op), r.clock);
    hash = mixed(mixed(hash, r.queue_end), r.task);
  }
  for (const Ns word : taken) hash = mixed(hash, word);
  return hash;
}

Ns since(Ns time, Ns start) {
  return time > start ? time - start : 0;
}

/// In the order of turns.
bool before(Ns clock, std::uint32_t task, Ns other, std::uint32_t other_task) {
  return clock != other ? clock < other : task < other_task;
}

}  // namespace

Moments::Moments(const Compiler& compiler) : threads_(compiler) {
  threads_.reset(0);
  idle_ = known(0);
}

void Moments::bound_memory() {
  if (exact_ && bytes_ <= kMostBytes) return;
  exact_ = true;
  starts_.clear();
  moments_.clear();
  bytes_ = 0;
  running_.clear();
  threads_.reset(0);
  idle_ = known(0);
}

void Moments::load(const Moment& moment) {
  ++simulated_;
  running_ = moment.running;
  std::uint32_t threads = 0;
  for (const Running& r : running_) threads = std::max(threads, r.task + 1);
  threads_.reset(threads, moment.taken);
  for (const Running& r : running_) {
    threads_[r.task] = {r.compiled, r.free, r.clock, r.queue_end};
  }
}

/// Lets the running tasks take turns until one is through, whose index in running_ it returns, or
/// as long as theirs come before a turn of `before_task` at `until`.
std::size_t Moments::advance(Ns until, std::uint32_t before_task) {
  while (true) {
    std::size_t first = running_.size();
    Ns limit = until;
    std::uint32_t other = before_task;
    for (std::size_t i = 0; i < running_.size(); ++i) {
      const Running& r = running_[i];
      if (first == running_.size() ||
          before(r.clock, r.task, running_[first].clock, running_[first].task)) {
        if (first != running_.size() &&
            before(running_[first].clock, running_[first].task, limit, other)) {
          limit = running_[first].clock;
          other = running_[first].task;
        }
        first = i;
      } else if (before(r.clock, r.task, limit, other)) {
        limit = r.clock;
        other = r.task;
      }
    }
    if (first == running_.size()) return first;
    Running& r = running_[first];
    if (!before(r.clock, r.task, until, before_task)) return running_.size();
    if (r.op == r.program->ops.size()) return first;
    r.op += static_cast<std::uint32_t>(threads_.steps(
        r.task, *r.program, r.op, limit + (limit != Trace::kNot && r.task < other ? 1 : 0)));
    r.clock = threads_[r.task].clock;
    r.queue_end = threads_[r.task].queue_end;
  }
}

/// The moment `at` of what was simulated.
Moment* Moments::known(Ns at) {
  Moment moment;
  moment.running = running_;
  for (Running& r : moment.running) {
    r.queue_end = r.queue_end > std::max(r.clock, at) ? r.queue_end - at : 0;  // else as good as 0
    r.clock = since(r.clock, at);
  }
  timeline::Placement::Taken taken = threads_.calendars().save(at);
  exact_ = exact_ && taken.all;
  moment.taken = std::move(taken.words);
  moment.taken_until = taken.until;
  const std::uint64_t hash = hash_of(moment.running, moment.taken);
  Moment* known = moments_.find(hash, [&](const Moment& other) {
    return other.running == moment.running && other.taken == moment.taken;
  });
  if (known != nullptr) return known;
  bytes_ += sizeof(Moment) + 8 * moment.taken.size() + sizeof(Running) * moment.running.size();
  return &moments_.add(hash, std::move(moment));
}

void AllHeld::add(const Held& held) {
  const auto same = [&](const Held& other) {
    return other.busy == 0 || (other.cores == held.cores && other.of == held.of);
  };
  const auto place = std::find_if(first.begin(), first.end(), same);
  if (place == first.end()) return more.push_back(held);
  *place = {place->busy + held.busy, held.of, held.cores};
}

AllHeld Moments::held() const {
  AllHeld all;
  threads_.each_busy(
      [&all](timeline::EngineKind kind, std::uint32_t node, std::uint32_t device, Ns busy) {
        if (kind == timeline::EngineKind::link) return;
        const bool cores = kind == timeline::EngineKind::core;
        all.add({busy, cores ? node : device, cores});
      });
  return all;
}

const Moments::Start& Moments::find_start(std::uint64_t hash, const Moment& moment,
                                          const Running& joining) {
  load(moment);
  exact_ = advance(joining.clock, joining.task) == running_.size() && exact_;
  Start start{&moment, joining, nullptr, held()};
  running_.push_back(joining);
  start.after = known(joining.clock);
  bytes_ += sizeof(Start);
  return starts_.add(hash, std::move(start));
}

const Moment::Finish& Moments::find_finish(Moment& moment) {
  load(moment);
  const std::size_t first = advance(Trace::kNot, kNone);
  const Running through = running_[first];
  threads_.finish(through.task, *through.program);
  Moment::Finish& finish = moment.finish;
  finish.time = through.clock;
  finish.queue_end = through.queue_end;
  finish.task = through.task;
  finish.held = held();
  running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(first));
  finish.after = known(through.clock);
  return finish;
}

}  // namespace partita::partition
