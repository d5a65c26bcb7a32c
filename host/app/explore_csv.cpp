// explore.csv: for spreadsheets and scripts. Its columns are documented in docs/outputs.md.
#include <fmt/format.h>

#include "host/app/explore.h"

namespace partita::app {
namespace {

/// Quoted where CSV needs it: a machine file may have any name.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted;
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return fmt::format("\"{}\"", quoted);
}

std::string line(const ExploreReport& report, const partition::MachineResult& result,
                 const partition::Scored& point, bool joint) {
  const partition::Score& s = point.score;
  const partition::Vehicle& vehicle = report.options.vehicle;
  std::string text =
      fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}", cell(result.machine),
                  point.placement == result.best->placement ? 1 : 0, joint ? 1 : 0, s.p50_ns,
                  s.p99_ns, s.energy_j, s.power_w, s.throughput_hz(), s.dropped, s.area,
                  s.price_usd, partition::added_stopping_distance_m(vehicle, s.p99_ns),
                  partition::driving_hours(vehicle, s.power_w));
  for (std::uint32_t t = 0; t < point.placement.size(); ++t) {
    text.append(",").append(cell(report.place(result, point.placement, t)));
  }
  return text + "\n";
}

}  // namespace

std::string to_csv(const ExploreReport& report) {
  std::string text =
      "machine,best,joint_front,latency_p50_ns,latency_p99_ns,energy_j,power_w,throughput_hz,"
      "dropped_share,fpga_area_share,price_usd,added_stopping_m,driving_hours";
  for (const partition::PipelineTask& task : report.pipeline.tasks)
    text.append(",").append(cell(task.name));
  text += "\n";
  const auto& machines = report.exploration.machines;
  for (std::size_t m = 0; m < machines.size(); ++m) {
    std::vector<bool> joint(machines[m].front.size(), false);
    for (const partition::FrontPoint& point : report.exploration.front) {
      if (point.machine == m) joint[point.point] = true;
    }
    for (std::size_t p = 0; p < joint.size(); ++p) {
      text += line(report, machines[m], machines[m].front[p], joint[p]);
    }
  }
  return text;
}

}  // namespace partita::app
