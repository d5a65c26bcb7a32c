#include "partition/simulate/messages.h"

#include <algorithm>
#include <utility>

namespace partita::partition {

void Messages::reset(const Scene& scene) {
  scene_ = &scene;
  networks_.clear();
  posts_.assign(scene.tasks.size() * scene.frames, Trace::kNot);
  delivered_.assign(scene.channels->all.size() * compiler_.layout().nodes.size() * scene.frames,
                    Trace::kNot);
  link_bytes_.assign(compiler_.layout().links.size(), 0);
}

Ns Messages::deliver(std::uint32_t task, std::uint32_t channel, std::size_t frame,
                     std::uint32_t home, Ns posted) {
  const std::uint32_t node = scene_->tasks[task]->node;
  if (home == node) return posted;
  const std::size_t nodes = compiler_.layout().nodes.size();
  Ns& there = delivered_[(channel * nodes + node) * scene_->frames + frame];
  if (there == Trace::kNot) {
    const std::uint64_t bytes = scene_->channels->all[channel].bytes;
    there = networks_.network(0, home, node, posted, bytes).end;
    if (bytes > 0) link_bytes_[compiler_.link_between(home, node)] += bytes;
  }
  return there;
}

/// What is sent from now on was posted then or later.
Ns Messages::earliest_post(Ns at, std::size_t first, std::size_t last) const {
  Ns earliest = std::min(at, first * scene_->pipeline->period_ns);
  for (std::size_t task = 0; task < scene_->tasks.size(); ++task) {
    for (std::size_t k = first; k < last; ++k) {
      earliest = std::min(earliest, posts_[task * scene_->frames + k]);
    }
  }
  return earliest;
}

void Messages::save(Ns at, std::size_t first, std::size_t last, std::vector<Ns>& words) const {
  for (const auto* times : {&posts_, &delivered_}) {
    for (std::size_t row = 0; row < times->size(); row += scene_->frames) {
      for (std::size_t k = first; k < last; ++k) {
        const Ns time = (*times)[row + k];
        words.push_back(time == Trace::kNot ? time : time - at);
      }
    }
  }
  const Ns since = earliest_post(at, first, last);
  const std::vector<Ns> taken = networks_.save(since).words;
  words.push_back(at - since);
  words.insert(words.end(), taken.begin(), taken.end());
}

void Messages::forward(Ns time, std::size_t frames, std::size_t first, std::size_t last) {
  const Ns since = earliest_post(first * scene_->pipeline->period_ns, first, last);
  networks_.restore(networks_.save(since).words, since + time);
  for (auto* times : {&posts_, &delivered_}) {
    for (std::size_t row = 0; row < times->size(); row += scene_->frames) {
      for (std::size_t k = last; k-- > first;) {
        const Ns old = std::exchange((*times)[row + k], Trace::kNot);
        (*times)[row + k + frames] = old == Trace::kNot ? old : old + time;
      }
    }
  }
}

Ns Messages::sensor(std::uint32_t task, std::size_t frame) {
  return deliver(task, scene_->channels->sensors[task], frame, compiler_.layout().sensor_node,
                 frame * scene_->pipeline->period_ns);
}

Ns Messages::message(std::uint32_t task, std::uint32_t input, std::size_t frame) {
  const std::uint32_t channel = scene_->channels->inputs[task][input];
  const std::uint32_t from = scene_->channels->all[channel].from;
  return deliver(task, channel, frame, scene_->tasks[from]->node,
                 posts_[from * scene_->frames + frame]);
}

}  // namespace partita::partition
