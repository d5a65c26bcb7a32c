#include "partition/search/sanity.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "devices/profile/error.h"

namespace partita::partition {
namespace {

/// Sums of many roundings may differ in their last digits.
constexpr double kSlack = 1 + 1e-9;

class Gate {
 public:
  Gate(const Evaluator& evaluator, const TaskPlacement& placement)
      : evaluator_(evaluator), placement_(placement) {}

  void positive(const char* what, double value, const char* unit) const {
    if (!(value > 0) || !std::isfinite(value)) refuse(what, value, unit, "expected more than 0");
  }
  void at_least(const char* what, double value, double least, const char* unit,
                const char* why) const {
    if (value * kSlack >= least) return;
    char text[120];
    std::snprintf(text, sizeof text, "expected at least %.6g, %s", least, why);
    refuse(what, value, unit, text);
  }
  void at_most(const char* what, double value, double most, const char* unit,
               const char* why) const {
    if (value <= most * kSlack) return;
    char text[120];
    std::snprintf(text, sizeof text, "expected at most %.6g, %s", most, why);
    refuse(what, value, unit, text);
  }

 private:
  [[noreturn]] void refuse(const char* what, double value, const char* unit,
                           const char* expected) const {
    char number[64];
    std::snprintf(number, sizeof number, " of %.6g %s", value, unit);
    throw profile::Error("machine '" + evaluator_.machine().id + "', placement " +
                         evaluator_.name(placement_) + ": impossible " + what + number + ", " +
                         expected);
  }

  const Evaluator& evaluator_;
  const TaskPlacement& placement_;
};

/// All parts at full load; what bytes moved add to it is in the factor, as in devices/model.
double most_power(const profile::Machine& machine) {
  double watts = 0;
  for (const profile::MachineDevice& device : machine.devices) {
    if (!device.is_host_cpu) watts += device.profile.power.busy_w;
  }
  for (const profile::Node& node : machine.nodes) watts += node.host.power.busy_w;
  return 1.5 * watts;
}

void check_latency(const Gate& gate, const Figures& figures, const Bounds& bounds) {
  const auto p50 = static_cast<double>(figures.latency.p50);
  const auto p99 = static_cast<double>(figures.latency.p99);
  const auto max = static_cast<double>(figures.latency.max);
  gate.positive("latency p50", p50, "ns");
  gate.positive("mean latency", figures.latency.mean, "ns");
  gate.at_most("latency p50", p50, p99, "ns", "the p99");
  gate.at_most("latency p99", p99, max, "ns", "the longest");
  gate.at_most("mean latency", figures.latency.mean, max, "ns", "the longest");
  gate.at_least("latency p50", p50, bounds.p50_ns, "ns", "critical path and load");
  gate.at_least("latency p99", p99, bounds.p99_ns, "ns", "critical path and load");
}

}  // namespace

void check_plausible(const Evaluator& evaluator, const TaskPlacement& placement,
                     const Figures& figures, const Bounds& bounds) {
  const Gate gate(evaluator, placement);
  check_latency(gate, figures, bounds);
  gate.positive("energy per frame", figures.energy_per_frame_j, "J");
  gate.at_least("energy per frame", figures.energy_per_frame_j, bounds.energy_j, "J",
                "idle power and the tasks' own");
  gate.positive("power", figures.power_w, "W");
  gate.at_most("power", figures.power_w, most_power(evaluator.machine()), "W",
               "1.5 x all parts at full load");
  gate.at_least("price", figures.price_usd, 0, "USD", "nothing");
  gate.at_least("price", figures.price_usd, bounds.price_usd, "USD", "the parts in use");
  if (figures.throughput_hz != 0) {  // a single frame has none
    gate.positive("throughput", figures.throughput_hz, "Hz");
    // From the first frame's end to the last one's. That is shorter than the frames' share by what
    // was done ahead before the first end, and by what the first frame takes above the mean: one
    // latency each.
    const std::size_t gaps =
        bounds.finished > figures.dropped + 2 ? bounds.finished - figures.dropped - 1 : 1;
    const double slack = 2 * static_cast<double>(figures.latency.max) / static_cast<double>(gaps);
    gate.at_least("time between frames", 1e9 / figures.throughput_hz + slack, bounds.frame_ns, "ns",
                  "the slowest task and the busiest engine");
  }
  for (const EngineUse& engine : figures.engines) {
    const std::string what = "utilisation of " + engine.name;
    gate.at_most(what.c_str(), engine.share, 1, "", "all of the time");
    gate.at_least(what.c_str(), engine.share, 0, "", "none of the time");
  }
}

Score score_of(const Evaluator& evaluator, const TaskPlacement& placement, const Figures& figures,
               const Bounds& bounds) {
  check_plausible(evaluator, placement, figures, bounds);
  Score score;
  score.p50_ns = static_cast<double>(figures.latency.p50);
  score.p99_ns = static_cast<double>(figures.latency.p99);
  score.energy_j = figures.energy_per_frame_j;
  score.frame_ns = bounds.frame_ns;
  if (figures.throughput_hz > 0) {
    score.frame_ns = std::max(bounds.frame_ns, 1e9 / figures.throughput_hz);
  }
  std::uint64_t due = 0;
  for (const PipelineTask& task : evaluator.pipeline().tasks) {
    due += (evaluator.frames() + task.every - 1) / task.every;
  }
  score.dropped = static_cast<double>(figures.dropped_by_tasks) / static_cast<double>(due);
  score.price_usd = figures.price_usd;
  score.power_w = figures.power_w;
  const auto& devices = evaluator.machine().devices;
  for (std::uint32_t d = 0; d < devices.size(); ++d) {
    if (devices[d].profile.type != profile::DeviceType::fpga) continue;
    score.area = std::max(
        score.area, scarcest_share(evaluator.area(placement, d), devices[d].profile.fabric.area));
  }
  return score;
}

double scarcest_share(const profile::Area& used, const profile::Area& available) {
  double share = 0;
  const auto add = [&](std::uint64_t needs, std::uint64_t has) {
    if (needs > 0) share = std::max(share, static_cast<double>(needs) / static_cast<double>(has));
  };
  add(used.lut, available.lut);
  add(used.ff, available.ff);
  add(used.bram36, available.bram36);
  add(used.uram, available.uram);
  add(used.dsp, available.dsp);
  return share;
}

}  // namespace partita::partition
