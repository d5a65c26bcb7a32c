// The vocabulary of the timeline and of its record: ids, kinds of commands, times.
#ifndef PARTITA_DEVICES_TIMELINE_COMMAND_H
#define PARTITA_DEVICES_TIMELINE_COMMAND_H

#include <cstdint>
#include <span>
#include <string_view>

#include "devices/timeline/layout.h"
#include "devices/work.h"

namespace partita::timeline {

using ThreadId = std::uint32_t;
using QueueId = std::uint32_t;
using DeviceId = std::uint32_t;  ///< index into Layout::devices
using EngineId = std::uint32_t;
using NodeId = std::uint32_t;  ///< a command, user event, host step or sensor transfer
using NameId = std::uint32_t;  ///< an interned string; 0 is the empty one
inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;

enum class CommandKind : std::uint8_t {
  kernel,     ///< `demand` on the device's compute engine
  write,      ///< `bytes` from the thread's node to the device (also unmap, migrate to device)
  read,       ///< `bytes` from the device to the thread's node (also migrate to host)
  map,        ///< as read; moves nothing where host and device share memory
  unmap,      ///< as write; moves nothing where host and device share memory
  copy,       ///< inside the device's memory: `demand` from DeviceModel::copy
  fill,       ///< inside the device's memory: `demand` from DeviceModel::fill
  marker,     ///< waits for its list, or for all earlier commands of the queue
  barrier,    ///< a marker that all later commands of the queue wait for
  load,       ///< a container is loaded: `demand` on all engines of the device, which must be idle
  host_step,  ///< made by Timeline::host_step
  sensor_input,  ///< made by Timeline::sensor_input
  user_event,    ///< made by Timeline::create_user_event
  message,       ///< made by Timeline::message
  count_,
};
std::string_view to_string(CommandKind kind);

/// The four times of clGetEventProfilingInfo. QUEUED <= SUBMIT <= START <= END.
struct Times {
  Ns queued = 0, submit = 0, start = 0, end = 0;
  bool operator==(const Times&) const = default;
};

/// A command as the layer hands it over. Fields that its kind does not use stay as they are here.
struct Command {
  QueueId queue = kNone;
  CommandKind kind = CommandKind::kernel;
  NameId name = 0;  ///< kernel's name; on an FPGA it also names the engine
  std::span<const NodeId> waits = {};
  Demand demand = {};               ///< kernel, copy, fill, load
  std::uint64_t bytes = 0;          ///< write, read, map, unmap
  std::uint32_t compute_units = 1;  ///< FPGA kernel: circuits of this name side by side, 1..64
  const Work* work = nullptr;       ///< kernel: kept in the record
  model::Launch launch = {};        ///< kernel: kept in the record
};

/// At which of an event's times its callback runs.
enum class CallbackAt : std::uint8_t { submit, start, end };

}  // namespace partita::timeline

#endif  // PARTITA_DEVICES_TIMELINE_COMMAND_H
