// explore.json: inputs and options first, then all that is predicted, machine by machine.
#include <fmt/format.h>

#include "host/app/explore.h"

namespace partita::app {
namespace {

using partition::MachineResult;
using partition::Objective;
using partition::Score;

constexpr const char* kNote =
    "all figures but prices are predicted, by simulation of the declared machines; nothing here "
    "is measured";

Json to_json(const partition::Distribution& d) {
  return {{"mean_ns", d.mean}, {"p50_ns", d.p50}, {"p99_ns", d.p99}, {"max_ns", d.max}};
}

Json to_json(const Score& s) {
  return {{"latency_p50_ns", s.p50_ns},
          {"latency_p99_ns", s.p99_ns},
          {"energy_j", s.energy_j},
          {"power_w", s.power_w},
          {"throughput_hz", s.throughput_hz()},
          {"dropped_share", s.dropped},
          {"fpga_area_share", s.area},
          {"price_usd", s.price_usd}};
}

Json to_json(const profile::Area& area) {
  return {{"lut", area.lut},
          {"ff", area.ff},
          {"bram36", area.bram36},
          {"uram", area.uram},
          {"dsp", area.dsp}};
}

Json to_json(const partition::Comparison& c) {
  return {{"beats", c.beats},          {"by", to_string(c.by)}, {"difference", c.nominal},
          {"least", c.least},          {"most", c.most},        {"corners", c.corners},
          {"dropped_share", c.dropped}};
}

class ExplorationJson {
 public:
  explicit ExplorationJson(const ExploreReport& report) : report_(report) {}

  Json inputs() const {
    const partition::Pipeline& pipeline = report_.pipeline;
    Json json;
    json["pipeline"] = {{"name", pipeline.id},
                        {"hash", pipeline.content_hash},
                        {"width", pipeline.width},
                        {"height", pipeline.height},
                        {"period_ns", pipeline.period_ns}};
    Json outlines = Json::array(), declared = Json::array();
    for (const partition::TaskWork& task : report_.workload.tasks) {
      if (task.outline) outlines.push_back(task.name);
      if (task.area_declared) declared.push_back(task.name);
    }
    json["workload"] = {{"origin", report_.workload.origin},
                        {"hash", report_.workload.hash},
                        {"by_work_alone", outlines},
                        {"areas_declared", declared}};
    for (const profile::Machine& machine : report_.machines) {
      Json item{{"name", machine.id},
                {"hash", machine.content_hash},
                {"description", machine.description},
                {"profiles", Json::object()}};
      for (const profile::MachineDevice& device : machine.devices) {
        item["profiles"][device.profile.id] = device.profile.content_hash;
      }
      for (const profile::Node& node : machine.nodes) {
        item["profiles"][node.host.id] = node.host.content_hash;
      }
      json["machines"].push_back(std::move(item));
    }
    return json;
  }

  Json options() const {
    const partition::SearchOptions& search = report_.exploration.options;
    Json json{{"objective", to_string(search.objective)},
              {"pins", Json::array()},
              {"limits", Json::object()}};
    for (const partition::Pin& pin : search.pins) json["pins"].push_back(pin.to_string());
    for (const partition::Limited what : partition::kLimited) {
      if (const auto& most = search.limits[what]) {
        json["limits"][std::string(to_string(what))] = show(what, *most);
      }
    }
    json["frames"] = report_.options.frames;
    json["allow_swap"] = report_.options.allow_swap;
    json["vehicle"] = {{"speed_mps", search.vehicle.speed_mps},
                       {"battery_wh", search.vehicle.battery_wh},
                       {"base_power_w", search.vehicle.base_power_w}};
    return json;
  }

  Json ranking() const {
    Json list = Json::array();
    const Objective objective = report_.exploration.options.objective;
    for (const partition::Ranked& ranked : report_.exploration.ranking) {
      const MachineResult& result = report_.exploration.machines[ranked.machine];
      Json item{{"machine", result.machine}, {"value", value(objective, result.best->score)}};
      if (!list.empty()) {
        item["tie_with_first"] = ranked.tie;
        item["behind_first"] = to_json(ranked.behind);
      }
      list.push_back(std::move(item));
    }
    return list;
  }

  Json front() const {
    Json list = Json::array();
    for (const partition::FrontPoint& point : report_.exploration.front) {
      const MachineResult& result = report_.exploration.machines[point.machine];
      const partition::Scored& scored = result.front[point.point];
      list.push_back({{"machine", result.machine},
                      {"placement", placement(result, scored.placement)},
                      {"score", to_json(scored.score)}});
    }
    return list;
  }

  Json machines() const {
    Json list = Json::array();
    for (const MachineResult& result : report_.exploration.machines)
      list.push_back(machine(result));
    return list;
  }

 private:
  Json placement(const MachineResult& result, const partition::TaskPlacement& placement) const {
    Json json = Json::object();
    for (std::uint32_t t = 0; t < placement.size(); ++t) {
      json[report_.pipeline.tasks[t].name] = report_.place(result, placement, t);
    }
    return json;
  }

  Json tasks(const MachineResult& result, const partition::Detailed& detailed) const {
    Json list = Json::array();
    for (std::uint32_t t = 0; t < detailed.figures.tasks.size(); ++t) {
      const partition::TaskFigures& f = detailed.figures.tasks[t];
      list.push_back({{"task", report_.pipeline.tasks[t].name},
                      {"place", report_.place(result, detailed.placement, t)},
                      {"by_work_alone", report_.workload.tasks[t].outline},
                      {"duration", to_json(f.duration)},
                      {"alone_ns", f.alone_ns},
                      {"latency", to_json(f.latency)},
                      {"late", f.late},
                      {"dropped", f.dropped}});
    }
    return list;
  }

  Json detailed(const MachineResult& result, const partition::Detailed& detailed) const {
    const partition::Figures& f = detailed.figures;
    Json json{{"placement", placement(result, detailed.placement)},
              {"score", to_json(detailed.score)},
              {"latency", to_json(f.latency)},
              {"perception", to_json(f.perception)},
              {"age", to_json(f.age)},
              {"late_frames", f.late},
              {"dropped_frames", f.dropped},
              {"makespan_ns", f.makespan}};
    json["tasks"] = tasks(result, detailed);
    json["engines"] = Json::array();
    for (const partition::EngineUse& engine : f.engines) {
      json["engines"].push_back(
          {{"engine", engine.name}, {"busy_ns", engine.busy}, {"share", engine.share}});
    }
    json["areas"] = Json::array();
    for (const partition::FpgaArea& area : detailed.areas) {
      json["areas"].push_back({{"device", area.device},
                               {"used", to_json(area.used)},
                               {"available", to_json(area.available)}});
    }
    json["vehicle"] = {{"added_stopping_m", detailed.added_stopping_m},
                       {"driving_hours", detailed.driving_hours}};
    return json;
  }

  Json rival(const MachineResult& result, const partition::Rival& rival) const {
    Json json = detailed(result, rival);
    json["changes"] = rival.changes;
    json["behind_best"] = to_json(rival.comparison);
    return json;
  }

  static Json explanation(const partition::Explanation& e) {
    Json json{{"lines", e.lines},
              {"critical_path", Json::array()},
              {"busiest_engine", e.busiest_engine},
              {"busiest_share", e.busiest_share},
              {"twice_as_fast", Json::array()}};
    for (const partition::PathStep& step : e.critical_path) {
      json["critical_path"].push_back({{"task", step.task},
                                       {"place", step.place},
                                       {"waited_ns", step.waited_ns},
                                       {"duration_ns", step.duration_ns},
                                       {"alone_ns", step.alone_ns}});
    }
    for (const partition::Sensitivity& s : e.sensitivities) {
      json["twice_as_fast"].push_back({{"what", s.what},
                                       {"score", to_json(s.score)},
                                       {"gain", s.gain},
                                       {"relative_gain", s.relative_gain}});
    }
    return json;
  }

  Json machine(const MachineResult& result) const {
    Json json{{"machine", result.machine},
              {"placements", result.placements},
              {"simulated", result.evaluated},
              {"infeasible", result.infeasible},
              {"beyond_limits", result.beyond_limits},
              {"method", to_string(result.method)},
              {"partial", result.stopped},
              {"refusals", Json::array()}};
    for (const partition::Refusal& refusal : result.refusals) {
      json["refusals"].push_back(
          {{"reason", refusal.reason}, {"count", refusal.count}, {"example", refusal.example}});
    }
    if (!result.best) {
      json["unreachable"] = result.unreachable;
      return json;
    }
    json["optimal"] = result.optimal;
    json["bound"] = result.bound;
    json["gap"] = result.gap;
    json["path_bound_ns"] = result.path_bound_ns;
    json["load_bound_ns"] = result.load_bound_ns;
    json["best"] = detailed(result, *result.best);
    json["explanation"] = explanation(result.explanation);
    json["uncertainty"] = Json::array();
    for (const partition::Part& part : result.parts) {
      json["uncertainty"].push_back(
          {{"part", part.name}, {"relative", part.uncertainty}, {"assumed", part.assumed}});
    }
    json["next"] = result.next ? rival(result, *result.next) : Json();
    json["all_ties"] = result.all_ties;
    json["ties"] = Json::array();
    for (const partition::Rival& tie : result.ties) json["ties"].push_back(rival(result, tie));
    json["exact_front"] = result.exact_front;
    json["front"] = Json::array();
    for (const partition::Scored& point : result.front) {
      json["front"].push_back(
          {{"placement", placement(result, point.placement)}, {"score", to_json(point.score)}});
    }
    return json;
  }

  const ExploreReport& report_;
};

}  // namespace

Json to_json(const ExploreReport& report) {
  const ExplorationJson parts(report);
  Json json;
  json["tool"] = "partita";
  json["kind"] = "exploration";
  json["version"] = PARTITA_VERSION;
  json["partial"] = report.partial();
  json["note"] = kNote;
  json["inputs"] = parts.inputs();
  json["options"] = parts.options();
  json["predicted"]["ranking"] = parts.ranking();
  json["predicted"]["machines"] = parts.machines();
  json["predicted"]["front"] = parts.front();
  json["files"] = report.files;
  return json;
}

}  // namespace partita::app
