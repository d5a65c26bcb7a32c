#include "devices/timeline/placement.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace partita::timeline {

Ns Placement::duration_of(std::uint64_t bytes, std::uint64_t bps) {
  constexpr std::uint64_t kShort = 18'000'000'000;  // times 10^9 it still fits 64 bits
  if (bytes < kShort) return std::min((bytes * 1000000000u + bps - 1) / bps, kLongest);
  const auto scaled = static_cast<unsigned __int128>(bytes) * 1000000000u;
  return static_cast<Ns>(std::min<unsigned __int128>((scaled + bps - 1) / bps, kLongest));
}

Placement::Placement(const Layout& layout, std::vector<Occupation>* sink)
    : layout_(layout), sink_(sink) {
  for (std::uint32_t n = 0; n < layout.nodes.size(); ++n) {
    const LayoutNode& node = layout.nodes[n];
    cores_.emplace_back();
    for (std::uint32_t c = 0; c < node.cores; ++c) {
      cores_.back().push_back(
          add_engine(node.name + "/core" + std::to_string(c), EngineKind::core, n, kNone, kNone));
    }
    memories_.push_back({node.memory_bps, {}});
  }
  for (std::uint32_t l = 0; l < layout.links.size(); ++l) {
    const LayoutLink& link = layout.links[l];
    const std::string &a = layout.nodes[link.a].name, &b = layout.nodes[link.b].name;
    networks_.push_back(add_engine(a + ">" + b, EngineKind::link, link.a, kNone, l));
    add_engine(b + ">" + a, EngineKind::link, link.b, kNone, l);
  }
  add_devices();
}

void Placement::add_devices() {
  for (DeviceId d = 0; d < layout_.devices.size(); ++d) {
    const LayoutDevice& device = layout_.devices[d];
    const std::string& node = layout_.nodes[device.node].name;
    DeviceEngines e;
    e.to_device = add_engine(node + ">" + device.name, EngineKind::link, device.node, d, kNone);
    e.from_device = add_engine(device.name + ">" + node, EngineKind::link, device.node, d, kNone);
    if (device.type == profile::DeviceType::gpu) {
      e.compute = add_engine(device.name, EngineKind::compute, device.node, d, kNone);
    } else if (device.type == profile::DeviceType::fpga) {
      e.copies = add_engine(device.name + "/copy", EngineKind::compute, device.node, d, kNone);
    }
    if (device.shared_memory) {
      e.memory = device.node;
    } else if (device.type == profile::DeviceType::fpga) {
      e.memory = static_cast<std::uint32_t>(memories_.size());
      memories_.push_back({device.memory_bps, {}});
    }
    devices_.push_back(std::move(e));
  }
}

EngineId Placement::add_engine(std::string name, EngineKind kind, std::uint32_t node,
                               DeviceId device, std::uint32_t network) {
  engines_.push_back({std::move(name), kind, node, device, network});
  busy_.emplace_back();
  worked_.push_back(0);
  return static_cast<EngineId>(engines_.size() - 1);
}

void Placement::clear() {
  for (auto& engine : busy_) engine.clear();
  std::fill(worked_.begin(), worked_.end(), 0);
  for (auto& memory : memories_) memory.taken.clear();
  for (auto& device : devices_) device.loaded = 0;
}

const std::vector<EngineId>& Placement::circuit(DeviceId device, NameId name,
                                                const std::string& text, std::uint32_t count) {
  auto& circuits = devices_[device].circuits;
  auto found = std::find_if(circuits.begin(), circuits.end(),
                            [&](const Circuit& c) { return c.name == name; });
  if (found == circuits.end()) found = circuits.insert(found, {name, {}});
  const LayoutDevice& d = layout_.devices[device];
  while (found->engines.size() < std::clamp(count, 1u, 64u)) {
    std::string engine = d.name + "/" + text;
    if (!found->engines.empty())
      engine.append("#").append(std::to_string(found->engines.size() + 1));
    found->engines.push_back(
        add_engine(std::move(engine), EngineKind::compute, d.node, device, kNone));
    busy_.back().close_before(devices_[device].loaded);
  }
  return found->engines;
}

std::uint32_t Placement::share_in(std::uint32_t memory, Ns busy, std::uint64_t bytes) const {
  return memory == kNone ? 0 : share_of(memories_[memory].bps, busy, bytes);
}

/// Integers from here on.
std::uint32_t Placement::share_of(std::uint64_t memory_bps, Ns busy, std::uint64_t bytes) {
  if (bytes == 0 || busy == 0) return 0;
  const double whole = static_cast<double>(busy) * static_cast<double>(memory_bps);
  const double share = static_cast<double>(bytes) * 1e9 / whole * Bandwidth::kWhole;
  return static_cast<std::uint32_t>(std::clamp(std::ceil(share), 1.0, 1.0 * Bandwidth::kWhole));
}

void Placement::occupy(NodeId id, EngineId engine, Ns start, Ns end) {
  busy_[engine].reserve(start, end);
  worked_[engine] += end - start;
  if (sink_ != nullptr && end > start) sink_->push_back({id, engine, start, end});
}

/// On the engine of the list where it starts first. The launch part draws no memory; the rest is
/// stretched where the memory is taken, and has to fit the gap as stretched.
Placed Placement::on_first_free(NodeId id, const EngineId* engines, std::size_t count,
                                std::uint32_t memory, Ns ready, Ns launch, Ns busy,
                                std::uint32_t share) {
  Bandwidth* taken = memory == kNone ? nullptr : &memories_[memory].taken;
  if (share > 0) ready = taken->open_from(ready);
  Placed best{std::numeric_limits<Ns>::max(), 0};
  EngineId chosen = engines[0];
  for (std::size_t i = 0; i < count; ++i) {
    Ns start = busy_[engines[i]].first_fit(ready, launch + busy), end = 0;
    for (bool fits = false; !fits;) {
      const Ns running = start + launch;
      end = share > 0 ? taken->stretched_end(running, busy, share) : running + busy;
      if (end == running + busy) break;  // as first_fit was asked for
      const Ns next = busy_[engines[i]].first_fit(start, end - start);
      fits = next == start;
      start = next;
    }
    if (start < best.start) {
      best = {start, end};
      chosen = engines[i];
    }
    if (start == ready) break;
  }
  occupy(id, chosen, best.start, best.end);
  if (share > 0) taken->reserve(best.start + launch, best.end, share);
  return best;
}

/// When each of the node's cores is free for good, from `ready` on; also in ascending order. False
/// if one of them has a gap before that.
bool Placement::cores_unbroken(std::uint32_t node, Ns ready) {
  const auto& cores = cores_[node];
  free_.resize(cores.size());
  starts_.resize(cores.size());
  for (std::size_t c = 0; c < cores.size(); ++c) {
    if (!busy_[cores[c]].unbroken_from(ready, free_[c])) return false;
    std::size_t place = c;
    for (; place > 0 && starts_[place - 1] > free_[c]; --place) starts_[place] = starts_[place - 1];
    starts_[place] = free_[c];
  }
  return true;
}

/// The earliest time >= ready at which `wanted` of the node's cores are free for `duration`.
Ns Placement::cores_free(std::uint32_t node, std::uint32_t wanted, Ns ready, Ns duration) {
  const auto& cores = cores_[node];
  starts_.resize(cores.size());
  for (Ns time = ready;;) {
    std::uint32_t at_once = 0;
    for (std::size_t c = 0; c < cores.size() && at_once < wanted; ++c) {
      starts_[c] = busy_[cores[c]].first_fit(time, duration);
      at_once += starts_[c] == time ? 1 : 0;
    }
    if (at_once == wanted) return time;
    std::nth_element(starts_.begin(), starts_.begin() + (wanted - 1), starts_.end());
    time = starts_[wanted - 1];
  }
}

Prepared Placement::prepare(DeviceId device, const Demand& demand) const {
  const LayoutDevice& d = layout_.devices[device];
  if (d.type != profile::DeviceType::cpu) {
    const Ns busy = std::max(demand.compute_ns, demand.memory_ns);
    return {demand, busy, share_in(devices_[device].memory, busy, demand.bytes), 0};
  }
  const LayoutNode& host = layout_.nodes[d.node];
  Prepared prepared{demand, 0, 0, std::clamp(demand.units, 1u, host.cores)};
  prepared.busy = busy_on(host, prepared, prepared.cores);
  prepared.share = share_in(d.node, prepared.busy, demand.bytes);
  return prepared;
}

Prepared Placement::prepare_inside(DeviceId device, Demand demand) const {
  demand.units = 1;
  return prepare(device, demand);
}

Prepared Placement::prepare_transfer(DeviceId device, std::uint64_t bytes) const {
  const LayoutDevice& d = layout_.devices[device];
  if (bytes == 0) return {};
  Prepared transfer;
  transfer.demand.launch_ns = d.link_latency_ns;
  transfer.demand.bytes = d.shared_memory ? 2 * bytes : 0;  // memcpy reads and writes
  transfer.busy = duration_of(bytes, d.link_bps);
  transfer.share = share_in(devices_[device].memory, transfer.busy, transfer.demand.bytes);
  return transfer;
}

Prepared Placement::prepare_step(std::uint32_t node, const Demand& demand) const {
  const Ns busy = std::max(demand.compute_ns, demand.memory_ns);
  return {demand, busy, share_in(node, busy, demand.bytes), 1};
}

/// Time that a kernel takes on some of the cores it can use.
Ns Placement::busy_on(const LayoutNode& host, const Prepared& command, std::uint32_t cores) const {
  const Demand& demand = command.demand;
  const Ns all = demand.compute_ns * command.cores;  // below 2^42 times at most 4,096
  Ns busy = std::max((all + cores - 1) / cores, demand.memory_ns);
  if (host.unit_memory_bps > 0) {
    busy = std::max(busy, duration_of(demand.bytes, host.unit_memory_bps * cores));
  }
  return busy;
}

/// A kernel on a CPU: more cores end it sooner but may be free later; the number of cores that
/// gives the earliest END (of equal ones the largest) is taken, the cores with the lowest numbers.
Placed Placement::on_cores(NodeId id, std::uint32_t node, Ns ready, const Prepared& command) {
  const LayoutNode& host = layout_.nodes[node];
  const Ns launch = command.demand.launch_ns;
  Bandwidth& taken = memories_[node].taken;
  ready = taken.open_from(ready);
  // Mostly the cores have no gaps: what is free from some time on is free for any duration.
  const bool unbroken = cores_unbroken(node, ready);
  Placed best{0, std::numeric_limits<Ns>::max()};
  std::uint32_t chosen = command.cores, chosen_share = command.share;
  for (std::uint32_t cores = command.cores; cores >= 1; --cores) {
    const bool all = cores == command.cores;
    const Ns busy = all ? command.busy : busy_on(host, command, cores);
    if (ready + launch + busy >= best.end) break;  // fewer cores only take longer
    const std::uint32_t share =
        all ? command.share : share_in(node, busy, command.demand.bytes);
    Ns start = unbroken ? starts_[cores - 1] : cores_free(node, cores, ready, launch + busy);
    Ns end = 0;
    for (bool fits = false; !fits;) {
      end = taken.stretched_end(start + launch, busy, share);
      if (unbroken || end == start + launch + busy) break;  // as cores_free was asked for
      const Ns next = cores_free(node, cores, start, end - start);
      fits = next == start;
      start = next;
    }
    if (end < best.end) {
      best = {start, end};
      chosen = cores;
      chosen_share = share;
    }
  }
  for (std::uint32_t c = 0, left = chosen; c < host.cores && left > 0; ++c) {
    const EngineId engine = cores_[node][c];
    const bool free = unbroken ? free_[c] <= best.start
                               : busy_[engine].first_fit(best.start, best.end - best.start) ==
                                     best.start;
    if (!free) continue;
    occupy(id, engine, best.start, best.end);
    --left;
  }
  taken.reserve(best.start + launch, best.end, chosen_share);
  return best;
}

Placed Placement::kernel(NodeId id, DeviceId device, NameId circuit_name, const std::string& name,
                         std::uint32_t compute_units, Ns ready, const Prepared& kernel) {
  const DeviceEngines& e = devices_[device];
  const Ns launch = kernel.demand.launch_ns;
  switch (layout_.devices[device].type) {
    case profile::DeviceType::cpu:
      return on_cores(id, layout_.devices[device].node, ready, kernel);
    case profile::DeviceType::gpu:
      return on_first_free(id, &e.compute, 1, e.memory, ready, launch, kernel.busy, kernel.share);
    case profile::DeviceType::fpga:
      break;
  }
  const auto& engines = circuit(device, circuit_name, name, compute_units);
  return on_first_free(id, engines.data(), engines.size(), e.memory, ready, launch, kernel.busy,
                       kernel.share);
}

Placed Placement::inside(NodeId id, DeviceId device, Ns ready, const Prepared& command) {
  const DeviceEngines& e = devices_[device];
  if (layout_.devices[device].type == profile::DeviceType::cpu) {
    return on_cores(id, layout_.devices[device].node, ready, command);
  }
  const EngineId engine = e.compute != kNone ? e.compute : e.copies;
  return on_first_free(id, &engine, 1, e.memory, ready, command.demand.launch_ns, command.busy,
                       command.share);
}

bool Placement::append(DeviceId device, Ns ready, std::span<const Prepared> commands, Ns& end) {
  const LayoutDevice& d = layout_.devices[device];
  if (d.type == profile::DeviceType::cpu) return append_on_cores(d.node, ready, commands, end);
  const EngineId engine = devices_[device].compute;
  Ns start = 0;
  if (engine == kNone || !busy_[engine].unbroken_from(ready, start)) return false;
  end = start;
  for (const Prepared& command : commands) end += command.alone();
  occupy(0, engine, start, end);
  return true;
}

/// Kernels that use all cores, and memory that is idle: no smaller number of cores ends one sooner,
/// and nothing stretches it.
bool Placement::append_on_cores(std::uint32_t node, Ns ready, std::span<const Prepared> commands,
                                Ns& end) {
  const auto& cores = cores_[node];
  Bandwidth& taken = memories_[node].taken;
  ready = taken.open_from(ready);
  Ns start = 0;
  for (std::size_t c = 0; c < cores.size(); ++c) {
    Ns own = 0;
    if (!busy_[cores[c]].unbroken_from(ready, own) || (c > 0 && own != start)) return false;
    start = own;
  }
  if (!taken.idle_from(start)) return false;
  end = start;
  for (const Prepared& command : commands) {
    taken.reserve(end + command.demand.launch_ns, end + command.alone(), command.share);
    end += command.alone();
  }
  for (const EngineId core : cores) occupy(0, core, start, end);
  return true;
}

Placed Placement::load(NodeId id, DeviceId device, Ns ready, const Demand& demand) {
  DeviceEngines& e = devices_[device];
  std::vector<EngineId> all;
  for (EngineId engine = 0; engine < engines_.size(); ++engine) {
    if (engines_[engine].device == device) all.push_back(engine);
  }
  const Ns duration = demand.launch_ns + std::max(demand.compute_ns, demand.memory_ns);
  Ns start = ready;
  for (std::size_t agreed = 0, i = 0; agreed < all.size(); i = (i + 1) % all.size()) {
    const Ns fit = busy_[all[i]].first_fit(start, duration);
    agreed = fit == start ? agreed + 1 : 1;
    start = fit;
  }
  for (const EngineId engine : all) {
    occupy(id, engine, start, start + duration);
    worked_[engine] -= duration;  // nothing works while it loads
  }
  e.loaded = std::max(e.loaded, start + duration);
  return {start, start + duration};
}

Placed Placement::transfer(NodeId id, DeviceId device, std::uint32_t node, bool to_device,
                           bool maps, Ns ready, std::uint64_t bytes) {
  const LayoutDevice& d = layout_.devices[device];
  if (bytes == 0) return {ready, ready};
  if (node != d.node && d.shared_memory) {
    // Received straight into, or sent straight from, the memory that host and device share.
    return to_device ? network(id, node, d.node, ready, bytes)
                     : network(id, d.node, node, ready, bytes);
  }
  const auto local = [&](Ns from) {
    Prepared transfer;
    transfer.demand.launch_ns = d.link_latency_ns;
    if (!d.shared_memory || !maps) transfer = prepare_transfer(device, bytes);
    return local_transfer(id, device, to_device, from, transfer);
  };
  if (node == d.node) return local(ready);
  if (to_device) {
    const Placed first = network(id, node, d.node, ready, bytes);
    return {first.start, local(first.end).end};
  }
  const Placed first = local(ready);
  return {first.start, network(id, d.node, node, first.end, bytes).end};
}

Placed Placement::local_transfer(NodeId id, DeviceId device, bool to_device, Ns ready,
                                 const Prepared& transfer) {
  const DeviceEngines& e = devices_[device];
  const EngineId engine = to_device ? e.to_device : e.from_device;
  return on_first_free(id, &engine, 1, transfer.share > 0 ? e.memory : kNone, ready,
                       transfer.demand.launch_ns, transfer.busy, transfer.share);
}

Placed Placement::network(NodeId id, std::uint32_t from, std::uint32_t to, Ns ready,
                          std::uint64_t bytes) {
  if (from == to || bytes == 0) return {ready, ready};
  for (std::uint32_t l = 0; l < layout_.links.size(); ++l) {
    const LayoutLink& link = layout_.links[l];
    const bool forth = link.a == from && link.b == to;
    if (!forth && !(link.b == from && link.a == to)) continue;
    const EngineId engine = networks_[l] + (forth ? 0 : 1);
    return on_first_free(id, &engine, 1, kNone, ready, link.latency_ns,
                         duration_of(bytes, link.bps), 0);
  }
  throw profile::Error("machine '" + layout_.machine + "': no link from node '" +
                       layout_.nodes[from].name + "' to '" + layout_.nodes[to].name + "'");
}

Ns Placement::latency(std::uint32_t from, std::uint32_t to) const {
  if (from == to) return 0;
  for (const LayoutLink& link : layout_.links) {
    if ((link.a == from && link.b == to) || (link.b == from && link.a == to)) {
      return link.latency_ns;
    }
  }
  return 0;
}

Placed Placement::core(NodeId id, std::uint32_t node, Ns ready, const Prepared& step) {
  const auto& cores = cores_[node];
  return on_first_free(id, cores.data(), cores.size(), node, ready, step.demand.launch_ns,
                       step.busy, step.share);
}

}  // namespace partita::timeline
