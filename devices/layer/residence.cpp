#include "devices/layer/residence.h"

namespace partita::layer {
namespace {

/// A sub-buffer, or an image made from a buffer, is where its parent is.
Memory& root_of(Memory& memory) {
  Memory* root = &memory;
  while (root->parent) root = root->parent.get();
  return *root;
}

}  // namespace

std::vector<MemoryUse> uses_of(const Kernel& kernel, const Queue& queue) {
  std::vector<MemoryUse> uses;
  if (queue.context->devices.size() < 2) return uses;
  const Lock lock(state().mutex);
  for (const KernelArg& arg : kernel.args) {
    if (arg.memory) uses.push_back({arg.memory, true, !arg.constant});
  }
  return uses;
}

Moves::Moves(const Queue& queue, timeline::ThreadId thread, std::span<const MemoryUse> uses,
             std::span<const timeline::NodeId> waits)
    : own_(waits) {
  if (queue.context->devices.size() < 2) return;
  for (const MemoryUse& use : uses) {
    const auto memory = state().memories.find(use.handle);
    if (!memory) continue;
    Memory& root = root_of(*memory);
    if (use.reads && root.home && root.home != queue.device) {
      move(*root.home, *queue.device, memory->bytes, thread);
      root.home = nullptr;  // both have it
    }
    if (use.writes) root.home = queue.device;
  }
}

Moves::~Moves() {
  const std::size_t first = all_.size() - moves_;
  for (std::size_t i = first; i < all_.size(); ++i) state().timeline->release(all_[i]);
}

void Moves::move(Device& from, Device& to, std::uint64_t bytes, timeline::ThreadId thread) {
  if (!moves_) all_.assign(own_.begin(), own_.end());
  const timeline::NodeId read = transfer(from, timeline::CommandKind::read, bytes, own_, thread);
  all_.push_back(transfer(to, timeline::CommandKind::write, bytes, {&read, 1}, thread));
  ++moves_;
  state().timeline->release(read);
}

/// On a queue of its own: neither device's queues order it.
timeline::NodeId Moves::transfer(Device& device, timeline::CommandKind kind, std::uint64_t bytes,
                                 std::span<const timeline::NodeId> waits,
                                 timeline::ThreadId thread) {
  timeline::Timeline& timeline = *state().timeline;
  const timeline::QueueId queue = timeline.add_queue(device.index, false);
  timeline::Command command;
  command.queue = queue;
  command.kind = kind;
  command.name = timeline.intern("move between devices");
  command.waits = waits;
  command.bytes = bytes;
  const timeline::NodeId node = timeline.enqueue(thread, command);
  timeline.remove_queue(queue);
  return node;
}

}  // namespace partita::layer
