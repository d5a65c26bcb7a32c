// summary.json and the summary for people. Predicted, measured and accuracy never mix.
#include <fmt/format.h>

#include "host/app/environment.h"
#include "host/app/run.h"

namespace partita::app {
namespace {

using partition::Distribution;

constexpr const char* kDeviceBound =
    "device-bound: host code other than the declared host steps counts as free";

/// A path shorter than this, in metres, has no end error relative to its length.
constexpr double kShortestPath = 0.1;

Json or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}

std::optional<double> end_error_percent(const io::TrajectoryError& error) {
  if (error.distance < kShortestPath) return std::nullopt;
  return error.end_error_percent;
}

Json to_json(const Distribution& d) {
  return {{"mean_ns", d.mean}, {"p50_ns", d.p50}, {"p99_ns", d.p99}, {"max_ns", d.max}};
}

Json machine_json(const RunReport& report) {
  Json json;
  json["name"] = report.options.machine;
  if (!report.prediction) return json;
  const profile::Machine& machine = report.prediction->machine;
  json["hash"] = machine.content_hash;
  json["description"] = machine.description;
  json["profiles"] = Json::object();
  for (const profile::MachineDevice& device : machine.devices) {
    json["profiles"][device.profile.id] = device.profile.content_hash;
  }
  for (const profile::Node& node : machine.nodes) {
    json["profiles"][node.host.id] = node.host.content_hash;
  }
  return json;
}

Json placement_json(const RunReport& report) {
  Json json;
  for (const Branch branch : partition::kBranches) {
    const runtime::Session& session = report.pipeline.session(branch);
    Json item;
    item["device"] = session.device().name;
    item["kind"] = runtime::kind_of(session.device());
    item["platform"] = session.device().platform_name;
    if (!session.device().node.empty()) item["node"] = session.device().node;
    item["charged_variant"] = to_string(session.charged());
    item["executed_variant"] = to_string(session.executed());
    json[std::string(to_string(branch))] = std::move(item);
  }
  return json;
}

Json input_json(const RunReport& report) {
  Json json;
  const bool scenario = report.options.dataset.empty();
  json["kind"] = scenario ? "scenario" : "dataset";
  json["name"] = report.source.name();
  if (scenario) json["seed"] = report.options.seed;
  json["width"] = report.source.calibration().width;
  json["height"] = report.source.calibration().height;
  json["rate_hz"] = report.rate_hz;
  json["frames"] = report.frames;
  json["hash"] = report.input_hash;
  return json;
}

Json frames_json(const partition::Summary& summary) {
  Json list = Json::array();
  for (const partition::BranchFrame& frame : summary.perception) {
    Json item{{"frame", frame.frame}, {"arrival_ns", frame.arrival}};
    for (const partition::BranchSummary& branch : summary.branches) {
      for (const partition::BranchFrame& own : branch.frames) {
        if (own.frame == frame.frame) item[branch.name + "_ns"] = own.latency();
      }
    }
    item["perception_ns"] = frame.latency();
    list.push_back(std::move(item));
  }
  return list;
}

Json energy_json(const partition::Summary& summary) {
  Json json{{"per_frame_j", summary.energy_per_frame_j},
            {"mean_w", summary.mean_power_w},
            {"total_j", summary.energy.total()}};
  for (const timeline::EnergyItem& item : summary.energy.items) {
    json["items"].push_back({{"name", item.name},
                             {"idle_j", item.idle_j},
                             {"busy_j", item.busy_j},
                             {"transfer_j", item.transfer_j}});
  }
  return json;
}

Json predicted_json(const Prediction& prediction) {
  const partition::Summary& summary = prediction.summary;
  Json json;
  json["note"] = kDeviceBound;
  json["latency"]["perception"] = to_json(summary.latency);
  json["alone"] = Json::object();
  for (const partition::BranchSummary& branch : summary.branches) {
    json["latency"][branch.name] = to_json(branch.latency);
    json["alone"][branch.name] = to_json(branch.alone);
    json["branch_throughput_hz"][branch.name] = or_null(branch.throughput_hz);
  }
  for (const partition::TaskTime& task : summary.tasks) {
    json["tasks"].push_back({{"branch", task.branch},
                             {"task", task.task},
                             {"as_it_ran_ns", task.as_it_ran_ns},
                             {"alone_ns", task.alone_ns}});
  }
  json["frames_in_common"] = summary.perception.size();
  json["frames_processed"] = summary.processed;
  json["late_frames"] = summary.late;
  json["throughput_hz"] = or_null(summary.throughput_hz);
  json["makespan_ns"] = summary.makespan;
  for (const partition::EngineUse& engine : summary.engines) {
    json["utilisation"].push_back(
        {{"engine", engine.name}, {"busy_ns", engine.busy}, {"share", engine.share}});
  }
  json["energy"] = energy_json(summary);
  json["frames"] = frames_json(summary);
  return json;
}

double mean_wall_ms(const BranchRun& run) {
  double sum = 0;
  for (const WallFrame& frame : run.frames) sum += static_cast<double>(frame.end - frame.start);
  return run.frames.empty() ? 0 : sum / static_cast<double>(run.frames.size()) / 1e6;
}

Json measured_json(const RunReport& report) {
  Json json;
  json["note"] = "wall time on this computer; says nothing about an emulated device";
  json["start_up_s"] = report.measured.start_up_s;
  json["warm_up_s"] = report.measured.warm_up_s;
  json["total_s"] = report.measured.total_s;
  for (const Branch branch : partition::kBranches) {
    const BranchRun& run = report.run.of(branch);
    Json& item = json[std::string(to_string(branch))];
    item["mean_ms"] = mean_wall_ms(run);
    for (const WallFrame& frame : run.frames) {
      item["frames"].push_back(
          {{"frame", frame.frame}, {"ms", static_cast<double>(frame.end - frame.start) / 1e6}});
    }
  }
  return json;
}

Json accuracy_json(const RunReport& report) {
  Json json;
  if (const auto& error = report.accuracy.trajectory) {
    Json item{{"distance_m", error->distance},
              {"end_error_m", error->end_error},
              {"end_error_percent", or_null(end_error_percent(*error))},
              {"ate_rmse_m", error->ate_rmse}};
    if (error->segment) {
      item["t_rel_percent"] = error->segment->translation_percent;
      item["r_rel_deg_per_100m"] = error->segment->rotation_degrees_per_100m;
    }
    json["trajectory"] = std::move(item);
  }
  const DepthAccuracy& depth = report.accuracy.depth;
  Json item{{"density", depth.density}, {"frames_without_support", depth.frames_without_support}};
  if (const depth::Evaluation& e = depth.evaluation; e.compared > 0) {
    item["density_where_truth"] = e.density();
    item["bad1_percent"] = e.bad1_percent();
    item["bad3_percent"] = e.bad3_percent();
    item["mean_error_px"] = e.mean_error_px();
    item["pixels_compared"] = e.compared;
  }
  json["depth"] = std::move(item);
  json["tracked_frames"] = report.run.tracked_frames();
  return json;
}

std::string milliseconds(double ns) {
  return fmt::format("{:.2f}", ns / 1e6);
}

/// Both rates where the branches dropped different numbers of frames.
std::string rate_text(const partition::Summary& summary) {
  if (!summary.throughput_hz) return "n/a";
  std::string text = fmt::format("{:.1f} frames/s", *summary.throughput_hz);
  if (summary.perception.size() == summary.processed) return text;
  std::string each;
  for (const partition::BranchSummary& branch : summary.branches) {
    each += fmt::format("{}{} {:.1f}", each.empty() ? "" : ", ", branch.name,
                        branch.throughput_hz.value_or(0));
  }
  return text + " (" + each + ")";
}

std::string predicted_text(const Prediction& prediction, const Console& console) {
  const partition::Summary& summary = prediction.summary;
  Table table({"predicted latency, ms", "mean", "p50", "p99", "max", "alone (mean)"});
  const auto add = [&table](const std::string& name, const Distribution& d,
                            const std::string& alone) {
    table.add({name, milliseconds(d.mean), milliseconds(static_cast<double>(d.p50)),
               milliseconds(static_cast<double>(d.p99)), milliseconds(static_cast<double>(d.max)),
               alone});
  };
  for (const partition::BranchSummary& branch : summary.branches) {
    add(branch.name, branch.latency, milliseconds(branch.alone.mean));
  }
  const std::size_t common = summary.perception.size();
  add(common == summary.processed ? "perception"
                                  : fmt::format("perception ({} frames in common)", common),
      summary.latency, "");
  std::string busy;
  for (const partition::EngineUse& engine : summary.engines) {
    if (engine.share < 0.005) continue;
    busy += fmt::format("{}{} {:.0f} %", busy.empty() ? "" : ", ", engine.name, engine.share * 100);
  }
  return fmt::format(
      "{}predicted rate      {}, {} late; {:.2f} J a frame, {:.1f} W\n"
      "predicted use       {}\n"
      "                    ({})\n",
      table.to_string(console.colour()), rate_text(summary), summary.late,
      summary.energy_per_frame_j, summary.mean_power_w, busy, kDeviceBound);
}

std::string accuracy_text(const Accuracy& accuracy) {
  std::string text;
  if (accuracy.trajectory) {
    const auto percent = end_error_percent(*accuracy.trajectory);
    text += fmt::format("accuracy            end error {} of {:.1f} m, ATE {:.3f} m\n",
                        percent ? fmt::format("{:.2f} %", *percent) : "n/a",
                        accuracy.trajectory->distance, accuracy.trajectory->ate_rmse);
  }
  text += fmt::format("accuracy of depth   density {:.1f} %", accuracy.depth.density * 100);
  if (const depth::Evaluation& e = accuracy.depth.evaluation; e.compared > 0) {
    text += fmt::format(", bad-1 {:.2f} %, bad-3 {:.2f} %, mean error {:.2f} px", e.bad1_percent(),
                        e.bad3_percent(), e.mean_error_px());
  }
  return text + "\n";
}

}  // namespace

std::string RunReport::lost_tracking() const {
  const std::size_t tracked = run.tracked_frames();
  if (tracked == run.localization.size()) return {};
  return fmt::format("localization: tracked {} of {} frames", tracked, run.localization.size());
}

Json to_json(const RunReport& report) {
  Json json;
  json["tool"] = "partita";
  json["version"] = PARTITA_VERSION;
  json["partial"] = report.partial();
  json["machine"] = machine_json(report);
  json["placement"] = placement_json(report);
  json["execute"] = runtime::to_string(report.execute);
  json["input"] = input_json(report);
  for (const Branch branch : partition::kBranches) {
    json["dropped_frames"][std::string(to_string(branch))] = report.run.of(branch).dropped;
  }
  json["predicted"] = report.prediction ? predicted_json(*report.prediction) : Json();
  json["measured"] = measured_json(report);
  json["accuracy"] = accuracy_json(report);
  json["files"] = report.files;
  return json;
}

std::string to_text(const RunReport& report, const Console& console) {
  std::string text =
      fmt::format("{} frames of {}, {}x{} at {:g} Hz, on machine {}\n", report.frames,
                  report.source.name(), report.source.calibration().width,
                  report.source.calibration().height, report.rate_hz, report.options.machine);
  for (const Branch branch : partition::kBranches) {
    const runtime::Session& session = report.pipeline.session(branch);
    text +=
        fmt::format("{:<20}{} ({}{})\n", to_string(branch), session.device().name,
                    session.device().emulated() ? "emulated, on " : "real", session.device().node);
  }
  for (const Branch branch : partition::kBranches) {
    if (const auto& dropped = report.run.of(branch).dropped; !dropped.empty()) {
      text += fmt::format("dropped by {}: {} of {} frames\n", to_string(branch), dropped.size(),
                          report.frames);
    }
  }
  if (report.prediction) text += predicted_text(*report.prediction, console);
  text += fmt::format(
      "measured here       localization {:.1f} ms, scene {:.1f} ms a frame; start-up {:.2f} s, "
      "frames {:.2f} s\n",
      mean_wall_ms(report.run.of(Branch::localization)), mean_wall_ms(report.run.of(Branch::scene)),
      report.measured.start_up_s, report.measured.total_s);
  text += accuracy_text(report.accuracy);
  if (const std::string lost = report.lost_tracking(); !lost.empty()) {
    text += console.paint(Colour::yellow, lost) + "\n";
  }
  if (report.partial()) {
    text += console.paint(Colour::yellow, "partial") + ": the run ended early\n";
  }
  text += "written to " + report.options.out + ":\n";
  for (const std::string& file : report.files)
    text += "  " + report.options.out + "/" + file + "\n";
  return text;
}

}  // namespace partita::app
