// Placement: the machine's engines and memories, and where commands fit on them. It knows nothing
// of queues, events or threads: READY goes in, START and END out. For the timeline, and for the
// partitioner's simulator, which so places by the same rules.
#ifndef PARTITA_DEVICES_TIMELINE_PLACEMENT_H
#define PARTITA_DEVICES_TIMELINE_PLACEMENT_H

#include <span>
#include <string>
#include <vector>

#include "devices/timeline/calendar.h"
#include "devices/timeline/command.h"
#include "devices/timeline/timeline.h"

namespace partita::timeline {

struct Placed {
  Ns start = 0, end = 0;
};

/// A demand and what follows from it on its device, once for all times that it is placed.
struct Prepared {
  Demand demand;
  Ns busy = 0;              ///< after the launch, alone, on all the cores it can use
  std::uint32_t share = 0;  ///< of its memory's bandwidth meanwhile, in parts of Bandwidth::kWhole
  std::uint32_t cores = 0;  ///< CPU: that it can use
  Ns alone() const { return demand.launch_ns + busy; }
};

class Placement {
 public:
  Placement(const Layout& layout, std::vector<Occupation>* sink);

  /// Of a kernel.
  Prepared prepare(DeviceId device, const Demand& demand) const;
  /// Of a copy or fill inside the device's memory: one unit, whatever the demand says.
  Prepared prepare_inside(DeviceId device, Demand demand) const;
  /// Of `bytes` between the device and the host of its node.
  Prepared prepare_transfer(DeviceId device, std::uint64_t bytes) const;
  /// Of a host step.
  Prepared prepare_step(std::uint32_t node, const Demand& demand) const;

  /// A kernel: on a GPU's compute engine; on an FPGA the first free of the `compute_units`
  /// circuits that `circuit` names; on a CPU as many of at most demand.units cores as end it first.
  Placed kernel(NodeId id, DeviceId device, NameId circuit, const std::string& name,
                std::uint32_t compute_units, Ns ready, const Prepared& kernel);
  /// A copy or fill inside the device's memory.
  Placed inside(NodeId id, DeviceId device, Ns ready, const Prepared& command);
  /// Kernels, copies and fills that follow each other at once, the first from `ready` on, on a
  /// device whose memory nobody waits for. False, and nothing is placed, where a gap between other
  /// commands may have to be looked at: then they are placed one by one. `end`: of the last.
  bool append(DeviceId device, Ns ready, std::span<const Prepared> commands, Ns& end);
  /// All engines of the device, idle; circuits that appear later start after it.
  Placed load(NodeId id, DeviceId device, Ns ready, const Demand& demand);
  /// `bytes` between a node and a device, over the network where they are on different nodes.
  /// `maps`: nothing moves if host and device share the memory.
  Placed transfer(NodeId id, DeviceId device, std::uint32_t node, bool to_device, bool maps,
                  Ns ready, std::uint64_t bytes);
  /// Between the device and the host of its node.
  Placed local_transfer(NodeId id, DeviceId device, bool to_device, Ns ready,
                        const Prepared& transfer);
  /// `bytes` from node to node; free on the same one.
  Placed network(NodeId id, std::uint32_t from, std::uint32_t to, Ns ready, std::uint64_t bytes);
  /// A host step on the first free core.
  Placed core(NodeId id, std::uint32_t node, Ns ready, const Prepared& step);

  /// Latency of the network between two nodes; 0 on the same one.
  Ns latency(std::uint32_t from, std::uint32_t to) const;
  const std::vector<Engine>& engines() const { return engines_; }
  /// Time that each engine worked, by EngineId: held, but not by a load.
  const std::vector<Ns>& worked() const { return worked_; }
  /// The share of a memory's bandwidth, in parts of Bandwidth::kWhole, that `bytes` in `busy` ns are.
  static std::uint32_t share_of(std::uint64_t memory_bps, Ns busy, std::uint64_t bytes);
  /// ceil(bytes / bps) in nanoseconds, at most what a duration may be.
  static Ns duration_of(std::uint64_t bytes, std::uint64_t bps);
  /// Everything free again.
  void clear();
  /// What is taken from `from` on, in times since then: equal words, equal future.
  struct Taken {
    std::vector<Ns> words;
    Ns until = 0;     ///< nothing is from then on
    bool all = true;  ///< no calendar holds so much that its older half may be closed (kMaxGaps)
  };
  Taken save(Ns from) const;
  /// Everything free again but what was saved, `from` being `at` now.
  void restore(std::span<const Ns> words, Ns at = 0);

 private:
  struct Circuit {
    NameId name;
    std::vector<EngineId> engines;
  };
  struct DeviceEngines {
    EngineId to_device, from_device;
    EngineId compute = kNone;  ///< GPU
    EngineId copies = kNone;   ///< FPGA
    std::vector<Circuit> circuits;
    std::uint32_t memory = kNone;  ///< index into memories_; kNone: its engine has it to itself
    Ns loaded = 0;
  };
  struct Memory {
    std::uint64_t bps;
    Bandwidth taken;
  };

  EngineId add_engine(std::string name, EngineKind kind, std::uint32_t node, DeviceId device,
                      std::uint32_t network);
  void add_devices();
  const std::vector<EngineId>& circuit(DeviceId device, NameId name, const std::string& text,
                                       std::uint32_t count);
  std::uint32_t share_in(std::uint32_t memory, Ns busy, std::uint64_t bytes) const;
  Placed on_first_free(NodeId id, const EngineId* engines, std::size_t count, std::uint32_t memory,
                       Ns ready, Ns launch, Ns busy, std::uint32_t share);
  Placed on_cores(NodeId id, std::uint32_t node, Ns ready, const Prepared& command);
  bool append_on_cores(std::uint32_t node, Ns ready, std::span<const Prepared> commands, Ns& end);
  Ns busy_on(const LayoutNode& host, const Prepared& command, std::uint32_t cores) const;
  bool cores_unbroken(std::uint32_t node, Ns ready);
  Ns cores_free(std::uint32_t node, std::uint32_t wanted, Ns ready, Ns duration);
  void occupy(NodeId id, EngineId engine, Ns start, Ns end);

  const Layout& layout_;
  std::vector<Occupation>* sink_;
  std::vector<Engine> engines_;
  std::vector<BusyTimes> busy_;               ///< by EngineId
  std::vector<Ns> worked_;                      ///< by EngineId
  std::vector<std::vector<EngineId>> cores_;  ///< by node
  std::vector<Ns> starts_, free_;             ///< of cores_free, kept to save an allocation
  std::vector<EngineId> networks_;            ///< by link: a to b; the next engine is b to a
  std::vector<DeviceEngines> devices_;
  std::vector<Memory> memories_;  ///< one per node, then one per device that needs its own
};

}  // namespace partita::timeline

#endif  // PARTITA_DEVICES_TIMELINE_PLACEMENT_H
