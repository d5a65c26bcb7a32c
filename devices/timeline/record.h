// Record: the graph of what a program did, which no race between its threads can change: per host
// thread the sequence of its actions, and the commands with their Work and edges. replay() turns it
// into the canonical Schedule. It is also the simulator's input and what `export` writes.
#ifndef PARTITA_DEVICES_TIMELINE_RECORD_H
#define PARTITA_DEVICES_TIMELINE_RECORD_H

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "devices/timeline/command.h"

namespace partita::timeline {

enum class EngineKind : std::uint8_t { core, compute, link };

/// Something that does one thing at a time: a CPU core, a GPU's compute, an FPGA's circuit, one
/// direction of a link. One lane of a trace.
struct Engine {
  std::string name;  ///< "pc/core3", "gtx1060", "zcu102/orb_detect", "pc>gtx1060", "zynq>pc"
  EngineKind kind = EngineKind::compute;
  std::uint32_t node = 0;         ///< node it is on (of a link: where it starts)
  DeviceId device = kNone;        ///< kNone: a core or a network link
  std::uint32_t network = kNone;  ///< index into Layout::links
};

struct RecordedQueue {
  DeviceId device = 0;
  bool out_of_order = false;
};

struct RecordedCommand {
  CommandKind kind = CommandKind::kernel;
  NameId name = 0, task = 0;
  std::int64_t frame = -1;
  QueueId queue = kNone;       ///< kNone: user event, host step, sensor input
  std::uint32_t thread = 0;    ///< index into Record::threads
  std::uint32_t work = kNone;  ///< index into Record::works
  model::Launch launch;
  Demand demand;
  std::uint64_t bytes = 0;
  std::uint32_t compute_units = 1;
  bool has_list = false;  ///< given a wait list (a marker without one waits for its whole queue)
  std::uint32_t first_wait = 0, wait_count = 0;        ///< range of Record::waits
  std::uint64_t measured_start = 0, measured_end = 0;  ///< wall ns; both 0: not measured
  bool resolved = false;
  Times live;  ///< as the program saw them; zeros unless resolved
};

enum class ActionType : std::uint8_t {
  command,     ///< the command `arg` is enqueued, stepped, or (a user event) created
  wait,        ///< Record::waits[arg, arg + value)
  finish,      ///< queue `arg`
  observe,     ///< command `arg`
  wait_until,  ///< time `value`
  set_event,   ///< user event `arg` gets status -value
};

struct Action {
  ActionType type = ActionType::command;
  std::uint32_t arg = 0;
  std::uint64_t value = 0;
};

struct RecordedThread {
  std::string name;
  std::uint32_t rank = kNone;  ///< kNone: never bound
  std::uint32_t node = 0;
  Ns start = 0;                     ///< its clock before the first action
  std::uint32_t after = kNone;      ///< a callback: of this command,
  CallbackAt at = CallbackAt::end;  ///< at this time of it
  std::vector<Action> actions;
};

struct Record {
  Layout layout;
  std::vector<std::string> names{""};  ///< by NameId
  std::vector<Work> works;
  std::vector<RecordedQueue> queues;
  std::vector<RecordedThread> threads;
  std::vector<RecordedCommand> commands;
  std::vector<std::uint32_t> waits;  ///< commands, pooled
  bool complete = true;              ///< false: the limit of recorded commands was reached

  /// More than one thread enqueued: live times depended on a race, only replayed ones count.
  bool racing() const;
};

/// JSON lines, a header first and an end line last. The file appears whole or not at all.
/// Throws profile::Error if it cannot be written.
void save_record(const Record& record, const std::string& path);
void write_record(const Record& record, std::ostream& out);
/// Strict: anything unknown, missing, out of range or inconsistent throws profile::Error with one
/// line "<path>:<line>: …". What loads replays, or replay() says which thread is stuck.
Record load_record(const std::string& path);
Record read_record(std::istream& in, const std::string& path);

}  // namespace partita::timeline

#endif  // PARTITA_DEVICES_TIMELINE_RECORD_H
