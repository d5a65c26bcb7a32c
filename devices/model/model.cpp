#include "devices/model/model.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace partita::model {
namespace {

constexpr double kMostNs = 4398046511104.0;  // 2^42 ns, 73 minutes: longer is a slip of units

constexpr std::string_view kOpNames[] = {"int_add",    "int_mul",    "int_special",    "float_add",
                                         "float_mul",  "float_fma",  "float_special",  "double_add",
                                         "double_mul", "double_fma", "double_special", "atomic"};
constexpr std::string_view kKindNames[] = {"stream", "stencil", "gather",
                                           "dense",  "reduce",  "serial"};
constexpr std::string_view kBoundNames[] = {"launch",       "compute", "memory",
                                            "local memory", "port",    "occupancy"};

std::size_t at(WorkKind kind) {
  return static_cast<std::size_t>(kind);
}

/// Ceiling, so that work that takes any time takes at least a nanosecond.
std::uint64_t whole_ns(double seconds, const std::string& device) {
  const double ns = std::ceil(seconds * 1e9 - 1e-6);
  if (!(ns < kMostNs)) {
    throw profile::Error("device '" + device + "': a command of " + std::to_string(seconds) +
                         " s, expected at most 4398 s");
  }
  return ns <= 0 ? 0 : static_cast<std::uint64_t>(ns);
}

}  // namespace

std::string_view to_string(Bound bound) {
  return kBoundNames[static_cast<std::size_t>(bound)];
}
std::string_view to_string(OpClass c) {
  return kOpNames[static_cast<std::size_t>(c)];
}
std::string_view to_string(WorkKind k) {
  return kKindNames[at(k)];
}

DeviceModel::DeviceModel(const profile::DeviceProfile& profile)
    : id_(profile.id),
      type_(profile.type),
      perf_(profile.performance),
      launch_ns_(profile.host.launch_ns) {
  for (std::size_t i = 0; i < kOpClasses; ++i) {
    const double rate = perf_.ops_per_cycle[i] * perf_.clock_hz;
    unit_seconds_per_op_[i] = rate > 0 ? 1 / rate : std::numeric_limits<double>::infinity();
  }
}

/// Seconds that one unit needs for all operations at efficiency 1: the classes share the issue
/// slots, so their times add up.
double DeviceModel::compute_seconds(const Work& work, Cost& cost) const {
  double sum = 0, most = -1;
  for (std::size_t i = 0; i < kOpClasses; ++i) {
    if (work.ops[i] == 0) continue;
    const double seconds = static_cast<double>(work.ops[i]) * unit_seconds_per_op_[i];
    if (std::isinf(seconds)) {
      throw profile::Error("device '" + id_ + "': work with " + std::string(kOpNames[i]) +
                           " operations, expected none: the device has no unit for them");
    }
    if (seconds > most) {
      most = seconds;
      cost.heaviest = static_cast<OpClass>(i);
    }
    sum += seconds;
  }
  return sum;
}

Cost DeviceModel::finish(Cost cost, double compute_s, double memory_s) const {
  cost.launch_ns = launch_ns_;
  cost.compute_ns = whole_ns(compute_s, id_);
  cost.memory_ns = whole_ns(memory_s, id_);
  if (cost.memory_ns > cost.compute_ns && cost.bound != Bound::port) cost.bound = Bound::memory;
  if (cost.launch_ns > cost.busy_ns()) cost.bound = Bound::launch;
  return cost;
}

Cost DeviceModel::kernel(const Work& work, const Launch& launch, const Circuit& circuit) const {
  if (at(work.kind) >= kWorkKinds || work.loop_count > kMaxWorkLoops) {
    throw profile::Error("device '" + id_ + "': work of an unknown kind or with too many loops, " +
                         "expected a Work as devices/work.h has it");
  }
  switch (type_) {
    case profile::DeviceType::gpu:
      return gpu(work, launch);
    case profile::DeviceType::fpga:
      return fpga(work, circuit);
    case profile::DeviceType::cpu:
      break;
  }
  const auto cores = static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(launch.groups, 1, std::max(1u, perf_.units)));
  return cpu(work, cores);
}

Cost DeviceModel::gpu(const Work& work, const Launch& launch) const {
  const auto units = static_cast<double>(perf_.units);
  const auto items = static_cast<double>(std::max<std::uint64_t>(launch.group_items, 1));
  const auto groups = static_cast<double>(std::max<std::uint64_t>(launch.groups, 1));
  // Work-groups resident on one SM at a time.
  double resident = std::floor(perf_.max_items_per_unit / items);
  resident = std::min(resident, static_cast<double>(perf_.max_groups_per_unit));
  if (launch.local_bytes > 0) {
    const auto local = static_cast<double>(launch.local_bytes);
    resident =
        std::min(resident, std::floor(static_cast<double>(perf_.local_mem_per_unit) / local));
  }
  resident = std::max(resident, 1.0);
  const double per_unit = std::ceil(groups / units);  // groups that the busiest SM runs
  const double balance = groups / units / per_unit;   // share of SMs at work, on average
  const double in_flight = std::min(resident, per_unit) * items;
  const double hidden = std::min(1.0, in_flight / perf_.items_to_fill_unit);
  const double flying = std::min(resident * units, groups) * items;
  const double fed = std::min(1.0, flying / perf_.items_to_fill_memory);

  Cost cost;
  const double raw = compute_seconds(work, cost) / units;
  const double slots = raw / (perf_.compute_efficiency[at(work.kind)] * balance * hidden);
  const double local = static_cast<double>(work.local_bytes) /
                       (perf_.local_bandwidth * units * perf_.clock_hz * balance * hidden);
  const double bandwidth = perf_.memory_bandwidth * perf_.memory_efficiency[at(work.kind)] * fed;
  cost.bytes = work.unique();
  cost.bound = local > slots            ? Bound::local_memory
               : balance * hidden < 0.5 ? Bound::occupancy
                                        : Bound::compute;
  return finish(cost, std::max(slots, local), static_cast<double>(cost.bytes) / bandwidth);
}

Cost DeviceModel::fpga(const Work& work, const Circuit& circuit) const {
  const double clock = circuit.clock_hz > 0 ? circuit.clock_hz : perf_.clock_hz;
  const double ports = std::max(1u, circuit.memory_ports);
  Cost cost;
  const double operations = compute_seconds(work, cost) * perf_.clock_hz;  // cycles, one at a time
  // Somebody else's kernel declares no loops: one operation starts per cycle, and loads and stores
  // go one word per port and cycle.
  const double words =
      static_cast<double>(work.issued()) / (ports * static_cast<double>(perf_.port_bytes));
  const double cycles =
      work.loop_count > 0 ? static_cast<double>(work.cycles()) : std::max(operations, words);
  const double shared = perf_.memory_bandwidth * perf_.memory_efficiency[at(work.kind)];
  const double port = ports * perf_.port_bytes * clock;
  cost.bytes = work.unique();
  const double memory = static_cast<double>(cost.bytes) / std::min(shared, port);
  cost.bound = memory * clock > cycles && port < shared ? Bound::port : Bound::compute;
  return finish(cost, cycles / clock, memory);
}

Cost DeviceModel::cpu(const Work& work, std::uint32_t cores) const {
  Cost cost;
  cost.units = cores;
  cost.bound = Bound::compute;
  const double compute = compute_seconds(work, cost) /
                         (perf_.compute_efficiency[at(work.kind)] * static_cast<double>(cores));
  double bandwidth = perf_.memory_bandwidth * perf_.memory_efficiency[at(work.kind)];
  if (perf_.unit_memory_bandwidth > 0) {
    bandwidth = std::min(bandwidth, perf_.unit_memory_bandwidth * cores);
  }
  cost.bytes = work.unique();
  return finish(cost, compute, static_cast<double>(cost.bytes) / bandwidth);
}

Cost DeviceModel::host_step(const Work& work) const {
  if (at(work.kind) >= kWorkKinds) {
    throw profile::Error("device '" + id_ + "': a host step of an unknown kind of work");
  }
  Cost cost = cpu(work, 1);
  cost.launch_ns = 0;
  if (cost.bound == Bound::launch) cost.bound = Bound::compute;
  return cost;
}

Cost DeviceModel::fill(std::uint64_t bytes) const {
  // copy_bandwidth counts bytes copied; each is read and written, a fill only writes.
  Cost cost = copy(bytes / 2 + bytes % 2);
  cost.bytes = bytes;
  return cost;
}

Cost DeviceModel::copy(std::uint64_t bytes) const {
  Cost cost;
  cost.bytes = 2 * bytes;
  cost.bound = Bound::memory;
  return finish(cost, 0, static_cast<double>(bytes) / perf_.copy_bandwidth);
}

}  // namespace partita::model
