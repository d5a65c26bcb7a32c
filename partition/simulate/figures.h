// From the times of a simulation to its figures. Inside the partitioner only.
#ifndef PARTITA_PARTITION_SIMULATE_FIGURES_H
#define PARTITA_PARTITION_SIMULATE_FIGURES_H

#include <vector>

#include "partition/simulate/driver.h"

namespace partita::partition {

/// Which parts of a machine a placement needs: a device that no task is on is left out of price and
/// power, and so is a node with neither tasks nor sensors.
struct Parts {
  std::vector<bool> devices, nodes;
};
Parts parts_of(const Scene& scene, const profile::Machine& machine);
double price_of(const Parts& parts, const profile::Machine& machine);

/// What energy follows from.
struct Consumption {
  std::vector<Ns> device_busy;  ///< compute engines, added up
  std::vector<Ns> node_busy;    ///< cores, added up
  std::vector<std::uint64_t> device_bytes, node_bytes, link_bytes;
  Ns makespan = 0;
};
void add(std::vector<std::uint64_t>& sum, const std::vector<std::uint64_t>& more,
         std::size_t times);
/// All but the makespan.
void add(Consumption& sum, const Consumption& more, std::size_t times);
Consumption difference(Consumption whole, const Consumption& part);
/// By the formulas of docs/predicted-clock.md, of the parts used.
double joules(const Consumption& consumption, const Parts& parts, const profile::Machine& machine);

/// Who was busy for how long. The cores of a node count as one, since which of them it was means
/// nothing.
class EngineUses {
 public:
  explicit EngineUses(const profile::Machine& machine) : machine_(machine) {}
  void add(const std::string& engine, timeline::EngineKind kind, std::uint32_t node, Ns busy);
  /// Those that were busy at all, the busiest first.
  std::vector<EngineUse> by_share(Ns makespan) const;

 private:
  const profile::Machine& machine_;
  std::vector<EngineUse> uses_;
  std::vector<double> engines_;  ///< how many each of them is
};

/// Latest END of the tasks on a frame; kNot if one of them did not do it.
Ns last_end(const Trace& trace, const std::vector<std::uint32_t>& tasks, std::size_t frame);
/// Per second, of `count` frames that were finished between two times; 0 for fewer than two.
double rate_of(std::size_t count, Ns first, Ns last);

/// Late and dropped frames.
void count_frames(const Trace& trace, const Scene& scene, Figures& figures);
/// Latencies, rate, lateness and drops: what a search compares, besides what follows.
Figures figures_of(const Trace& trace, const Scene& scene);
void set_energy(Figures& figures, const Scene& scene, double joules, Ns makespan);
/// Ages, and Figures::tasks; a task's `alone_ns` is left at 0.
void add_details(const Trace& trace, const Scene& scene, Figures& figures);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SIMULATE_FIGURES_H
