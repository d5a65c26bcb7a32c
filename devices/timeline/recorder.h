// Recorder: keeps the graph while the timeline runs. Inside the timeline only.
#ifndef PARTITA_DEVICES_TIMELINE_RECORDER_H
#define PARTITA_DEVICES_TIMELINE_RECORDER_H

#include <span>
#include <unordered_map>
#include <vector>

#include "devices/timeline/chunked.h"
#include "devices/timeline/record.h"

namespace partita::timeline {

class Recorder {
 public:
  explicit Recorder(std::uint64_t limit) : limit_(limit) {}

  /// False once the limit of commands was reached: nothing is kept any more.
  bool open() const { return open_; }
  /// Forgets threads and commands; ids of commands count from `first_node` on.
  void restart(NodeId first_node);

  void queue(QueueId id, DeviceId device, bool out_of_order);
  std::uint32_t thread(const RecordedThread& thread);
  /// Node `id` is the next command; nodes come in order.
  void command(NodeId id, std::uint32_t thread, RecordedCommand command,
               std::span<const NodeId> waits, const Work* work);
  void action(std::uint32_t thread, ActionType type, std::uint32_t arg, std::uint64_t value);
  void wait(std::uint32_t thread, std::span<const NodeId> nodes);
  void measured(NodeId id, std::uint64_t start, std::uint64_t end);

  /// Whether the node is a command of this record, and which.
  bool has(NodeId id) const { return id >= first_ && id - first_ < commands_.size(); }
  std::uint32_t index(NodeId id) const { return id - first_; }
  NodeId first() const { return first_; }
  Record copy() const;

 private:
  std::uint32_t work_index(NameId name, const Work& work);
  std::uint32_t pool(std::span<const NodeId> nodes, std::uint32_t& count);

  Record record_;  ///< without its commands
  Chunked<RecordedCommand> commands_;
  std::uint64_t limit_;
  NodeId first_ = 0;
  bool open_ = true;
  std::vector<std::uint32_t> last_work_;  ///< by name: launches of a kernel often cost the same
  std::unordered_multimap<std::uint64_t, std::uint32_t> works_;  ///< hash to index
};

}  // namespace partita::timeline

#endif  // PARTITA_DEVICES_TIMELINE_RECORDER_H
