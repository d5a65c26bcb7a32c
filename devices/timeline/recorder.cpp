#include "devices/timeline/recorder.h"

#include <cstring>

namespace partita::timeline {
namespace {

std::uint64_t hash_of(const Work& work) {
  std::uint64_t words[sizeof(Work) / 8];
  static_assert(sizeof(Work) % 8 == 0);
  std::memcpy(words, &work, sizeof work);
  std::uint64_t hash = 0;
  for (const std::uint64_t word : words) {
    hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash;
}

bool same(const Work& a, const Work& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

void Recorder::restart(NodeId first_node) {
  record_.threads.clear();
  commands_.clear();
  record_.waits.clear();
  record_.works.clear();
  record_.complete = true;
  works_.clear();
  last_work_.clear();
  first_ = first_node;
  open_ = true;
}

void Recorder::queue(QueueId id, DeviceId device, bool out_of_order) {
  if (id >= record_.queues.size()) record_.queues.resize(id + 1);
  record_.queues[id] = {device, out_of_order};
}

std::uint32_t Recorder::thread(const RecordedThread& thread) {
  record_.threads.push_back(thread);
  return static_cast<std::uint32_t>(record_.threads.size() - 1);
}

std::uint32_t Recorder::work_index(NameId name, const Work& work) {
  if (name >= last_work_.size()) last_work_.resize(name + 1, kNone);
  std::uint32_t& last = last_work_[name];
  if (last != kNone && same(record_.works[last], work)) return last;
  const std::uint64_t hash = hash_of(work);
  const auto [from, to] = works_.equal_range(hash);
  for (auto it = from; it != to; ++it) {
    if (same(record_.works[it->second], work)) return last = it->second;
  }
  record_.works.push_back(work);
  last = static_cast<std::uint32_t>(record_.works.size() - 1);
  works_.emplace(hash, last);
  return last;
}

/// Nodes from before this record are left out: they are long done.
std::uint32_t Recorder::pool(std::span<const NodeId> nodes, std::uint32_t& count) {
  const auto first = static_cast<std::uint32_t>(record_.waits.size());
  for (const NodeId node : nodes) {
    if (has(node)) record_.waits.push_back(index(node));
  }
  count = static_cast<std::uint32_t>(record_.waits.size()) - first;
  return first;
}

void Recorder::command(NodeId id, std::uint32_t thread, RecordedCommand command,
                       std::span<const NodeId> waits, const Work* work) {
  if (commands_.size() >= limit_ || id - first_ != commands_.size()) {
    open_ = record_.complete = false;
    return;
  }
  command.thread = thread;
  command.has_list = !waits.empty();
  command.first_wait = pool(waits, command.wait_count);
  if (work != nullptr) command.work = work_index(command.name, *work);
  commands_.push_back(command);
  action(thread, ActionType::command, index(id), 0);
}

void Recorder::action(std::uint32_t thread, ActionType type, std::uint32_t arg,
                      std::uint64_t value) {
  record_.threads[thread].actions.push_back({type, arg, value});
}

void Recorder::wait(std::uint32_t thread, std::span<const NodeId> nodes) {
  std::uint32_t count = 0;
  const std::uint32_t first = pool(nodes, count);
  action(thread, ActionType::wait, first, count);
}

void Recorder::measured(NodeId id, std::uint64_t start, std::uint64_t end) {
  if (!has(id)) return;
  commands_[index(id)].measured_start = start;
  commands_[index(id)].measured_end = end;
}

Record Recorder::copy() const {
  Record record = record_;
  record.commands.reserve(commands_.size());
  for (std::size_t i = 0; i < commands_.size(); ++i) record.commands.push_back(commands_[i]);
  return record;
}

}  // namespace partita::timeline
