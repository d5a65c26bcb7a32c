// Schedule: what a replay gives: every command's times and the engines it held, and the figures
// that follow from them.
#ifndef PARTITA_DEVICES_TIMELINE_SCHEDULE_H
#define PARTITA_DEVICES_TIMELINE_SCHEDULE_H

#include <string>
#include <vector>

#include "devices/timeline/record.h"
#include "devices/timeline/timeline.h"

namespace partita::timeline {

struct ScheduledCommand {
  std::uint32_t command = 0;  ///< index into the record's commands, which has name, task, frame
  Times times;
  std::int32_t status = 0;  ///< negative: terminated
  bool resolved = true;     ///< false: its user event was never set
  EngineId engine = kNone;  ///< the first it held; kNone: none
};

struct Schedule {
  std::vector<ScheduledCommand> commands;  ///< in the record's order
  std::vector<Occupation> occupations;     ///< ordered by start, then engine; node = command
  std::vector<Engine> engines;
  Ns makespan = 0;  ///< the latest END or host clock

  /// Busy share of the makespan per engine, 0..1.
  std::vector<double> utilisation() const;
};

/// Runs the record through a fresh Timeline: always the thread with the smallest virtual time acts
/// next (ties: rank, then name, then the thread's content), unless what it refers to does not exist
/// yet. For a record with one thread the times equal the live ones. Throws profile::Error if no
/// thread can act (a wait that nothing ends).
Schedule replay(const Record& record);

/// Joules of a schedule on the machine it was recorded on; per device, then CPUs, then links.
struct EnergyItem {
  std::string name;
  double idle_j = 0;      ///< idle power over the makespan
  double busy_j = 0;      ///< power above idle while engines are busy
  double transfer_j = 0;  ///< bytes moved
  double total() const { return idle_j + busy_j + transfer_j; }
};
struct Energy {
  std::vector<EnergyItem> items;
  double total() const;
};
/// `fpga_share` is the share of an FPGA's dynamic power that one of its circuits draws when its
/// area is not known; see docs/predicted-clock.md.
inline constexpr double kFpgaShare = 0.25;
Energy energy(const Schedule& schedule, const Record& record, const profile::Machine& machine,
              double fpga_share = kFpgaShare);

}  // namespace partita::timeline

#endif  // PARTITA_DEVICES_TIMELINE_SCHEDULE_H
