#include "partition/simulate/messages.h"

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
