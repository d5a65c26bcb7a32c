#include "partition/simulate/compiled_clock.h"

namespace partita::partition {

void CompiledClock::reset(const Scene& scene) {
  const timeline::Layout& layout = compiler_.layout();
  scene_ = &scene;
  threads_.reset(scene.tasks.size());
  messages_.reset(scene);
  node_wakeup_.clear();
  const std::vector<Freedom> free = freedom_of(scene, compiler_);
  for (std::uint32_t i = 0; i < scene.tasks.size(); ++i) {
    threads_[i] = {scene.tasks[i], free[i], 0, 0};
    node_wakeup_.push_back(layout.nodes[scene.tasks[i]->node].wakeup_ns);
  }
  device_bytes_.assign(layout.devices.size(), 0);
  node_bytes_.assign(layout.nodes.size(), 0);
}

Ns CompiledClock::post(std::uint32_t i, std::size_t frame) {
  const CompiledTask& task = *scene_->tasks[i];
  const CompiledFrame& program = task.frame(frame + scene_->offset);
  threads_.finish(i, program);
  if (task.device != kNone) device_bytes_[task.device] += program.device_bytes;
  node_bytes_[task.node] += program.node_bytes;
  messages_.post(i, frame, threads_[i].clock);
  return threads_[i].clock;
}

Consumption CompiledClock::consumption() const {
  Consumption c;
  c.device_busy.assign(device_bytes_.size(), 0);
  c.node_busy.assign(node_bytes_.size(), 0);
  c.device_bytes = device_bytes_;
  c.node_bytes = node_bytes_;
  c.link_bytes = messages_.link_bytes();
  c.makespan = horizon();
  threads_.each_busy(
      [&c](timeline::EngineKind kind, std::uint32_t node, std::uint32_t device, Ns busy) {
        if (kind == timeline::EngineKind::core) c.node_busy[node] += busy;
        if (kind == timeline::EngineKind::compute) c.device_busy[device] += busy;
      });
  return c;
}

Ns CompiledClock::horizon() const {
  Ns latest = 0;
  for (std::uint32_t i = 0; i < node_wakeup_.size(); ++i) {
    latest = std::max({latest, threads_[i].clock, threads_[i].queue_end});
  }
  return latest;
}

}  // namespace partita::partition
