#include "host/app/diff.h"

#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "host/app/explore.h"
#include "host/io/json_file.h"
#include "host/runtime/error.h"

namespace partita::app {
namespace {

namespace fs = std::filesystem;
using Pointer = Json::json_pointer;

constexpr const char* kSummaryFile = "summary.json";

std::string file_of(const std::string& path) {
  std::error_code code;
  if (!fs::is_directory(path, code)) return path;
  const std::string run = path + "/" + kSummaryFile, exploration = path + "/" + kExploreFile;
  const bool is_run = fs::exists(run, code), is_exploration = fs::exists(exploration, code);
  if (is_run && is_exploration) {
    throw Error(fmt::format("{}: holds {} and {}, expected the path of one of them", path,
                            kSummaryFile, kExploreFile));
  }
  if (!is_run && !is_exploration) {
    throw Error(
        fmt::format("{}: holds neither {} nor {}, expected a folder that `partita run` or "
                    "`partita explore` wrote",
                    path, kSummaryFile, kExploreFile));
  }
  return is_run ? run : exploration;
}

/// The value there, or null.
Json at(const Json& json, const std::string& pointer) {
  const Pointer where(pointer);
  return json.contains(where) ? json.at(where) : Json();
}

std::string text_of(const Json& value) {
  if (value.is_null()) return "-";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string name_of(const Json& value) {
  return value.is_object() ? value.value("hash", "there") : text_of(value);
}

/// What two objects have under different values, as "prefix key".
void add_differences(Json& list, const std::string& prefix, const Json& a, const Json& b) {
  std::set<std::string> keys;
  for (const Json* side : {&a, &b}) {
    if (!side->is_object()) continue;
    for (const auto& [key, value] : side->items()) keys.insert(key);
  }
  for (const std::string& key : keys) {
    const Json x = a.value(key, Json()), y = b.value(key, Json());
    if (x.is_object() != y.is_object()) {
      // Whole and absent: a machine that only one side has. Its hash stands for it.
      list.push_back({{"what", prefix + key}, {"a", name_of(x)}, {"b", name_of(y)}});
    } else if (x.is_object()) {
      add_differences(list, fmt::format("{}{} ", prefix, key), x, y);
    } else if (x != y) {
      list.push_back({{"what", prefix + key}, {"a", text_of(x)}, {"b", text_of(y)}});
    }
  }
}

/// The list of objects as one object, by a member that names them.
Json by_name(const Json& list, const char* key) {
  Json object = Json::object();
  for (const Json& item : list) object[item.at(key).get<std::string>()] = item;
  return object;
}

class Figures {
 public:
  Figures(const Json& a, const Json& b) : a_(a), b_(b) {}

  /// Skipped if neither side has it.
  void add(const std::string& section, const std::string& figure, const char* unit,
           const std::string& pointer) {
    const std::optional<double> a = number(a_, pointer), b = number(b_, pointer);
    if (!a && !b) return;
    Json item{{"section", section}, {"figure", figure}, {"unit", unit}};
    item["a"] = a ? Json(*a) : Json();
    item["b"] = b ? Json(*b) : Json();
    const bool relative = a && b && (*a != 0 || *b == 0);
    item["difference_percent"] =
        relative ? Json(*a == *b ? 0 : 100 * (*b - *a) / std::abs(*a)) : Json();
    list_.push_back(std::move(item));
  }
  Json take() { return std::move(list_); }

 private:
  static std::optional<double> number(const Json& json, const std::string& pointer) {
    const Json value = at(json, pointer);
    return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
  }
  const Json &a_, &b_;
  Json list_ = Json::array();
};

void add_run_figures(Figures& figures) {
  for (const char* of : {"localization", "scene", "perception"}) {
    for (const char* figure : {"mean", "p50", "p99", "max"}) {
      figures.add("predicted", fmt::format("latency {} {}", of, figure), "ns",
                  fmt::format("/predicted/latency/{}/{}_ns", of, figure));
    }
    figures.add("predicted", fmt::format("latency {} alone, mean", of), "ns",
                fmt::format("/predicted/alone/{}/mean_ns", of));
  }
  figures.add("predicted", "late frames", "", "/predicted/late_frames");
  figures.add("predicted", "throughput", "Hz", "/predicted/throughput_hz");
  figures.add("predicted", "energy a frame", "J", "/predicted/energy/per_frame_j");
  figures.add("predicted", "power", "W", "/predicted/energy/mean_w");
  figures.add("measured", "localization", "ms", "/measured/localization/mean_ms");
  figures.add("measured", "scene", "ms", "/measured/scene/mean_ms");
  figures.add("measured", "start-up", "s", "/measured/start_up_s");
  figures.add("accuracy", "end error", "%", "/accuracy/trajectory/end_error_percent");
  figures.add("accuracy", "ATE", "m", "/accuracy/trajectory/ate_rmse_m");
  figures.add("accuracy", "depth more than 1 px off", "%", "/accuracy/depth/bad1_percent");
  figures.add("accuracy", "depth more than 3 px off", "%", "/accuracy/depth/bad3_percent");
  figures.add("accuracy", "depth density", "", "/accuracy/depth/density");
}

/// Of the best placement of one machine.
void add_best_figures(Figures& figures, const std::string& machine, const Json& tasks) {
  const std::string best = "/predicted/" + machine + "/best";
  const auto add = [&](const std::string& figure, const char* unit, const std::string& where) {
    figures.add(machine, figure, unit, best + where);
  };
  add("latency p50", "ns", "/score/latency_p50_ns");
  add("latency p99", "ns", "/score/latency_p99_ns");
  add("perception p99", "ns", "/perception/p99_ns");
  add("energy a frame", "J", "/score/energy_j");
  add("power", "W", "/score/power_w");
  add("throughput", "Hz", "/score/throughput_hz");
  add("work dropped", "", "/score/dropped_share");
  add("late frames", "", "/late_frames");
  add("price", "USD", "/score/price_usd");
  add("FPGA area", "", "/score/fpga_area_share");
  add("added stopping distance", "m", "/vehicle/added_stopping_m");
  add("driving", "h", "/vehicle/driving_hours");
  for (const auto& [task, value] : tasks.items()) {
    add(task + ", mean", "ns", "/tasks/" + task + "/duration/mean_ns");
  }
}

/// As explore.json has it, but machines and tasks by name.
Json machines_by_name(const Json& exploration) {
  Json machines = by_name(exploration.at("predicted").at("machines"), "machine");
  for (auto& [name, machine] : machines.items()) {
    if (machine.contains("best")) {
      machine["best"]["tasks"] = by_name(machine["best"].at("tasks"), "task");
    }
  }
  return machines;
}

Json compare_runs(const Json& a, const Json& b) {
  Json document;
  const auto inputs = [](const Json& json) {
    Json all;
    for (const char* key : {"version", "machine", "input", "execute"}) {
      all[key] = json.value(key, Json());
    }
    return all;
  };
  document["inputs"] = Json::array();
  add_differences(document["inputs"], "", inputs(a), inputs(b));
  document["placement"] = Json::array();
  add_differences(document["placement"], "", a.at("placement"), b.at("placement"));
  Figures figures(a, b);
  add_run_figures(figures);
  document["figures"] = figures.take();
  return document;
}

Json compare_explorations(const Json& a, const Json& b) {
  Json document;
  const auto inputs = [](const Json& json) {
    Json all{{"version", json.value("version", Json())}};
    all.update(json.at("inputs"));
    all["machine"] = by_name(json.at("inputs").at("machines"), "name");
    all.erase("machines");
    all["option"] = json.at("options");
    return all;
  };
  document["inputs"] = Json::array();
  add_differences(document["inputs"], "", inputs(a), inputs(b));
  const Json x = machines_by_name(a), y = machines_by_name(b);
  document["placement"] = Json::array();
  Json both_a, both_b;
  both_a["predicted"] = x;
  both_b["predicted"] = y;
  Figures figures(both_a, both_b);
  for (const auto& [name, machine] : x.items()) {
    if (!machine.contains("best") || !y.contains(name) || !y[name].contains("best")) continue;
    add_differences(document["placement"], name + " ", machine["best"]["placement"],
                    y[name]["best"]["placement"]);
    add_best_figures(figures, name, machine["best"]["tasks"]);
  }
  document["figures"] = figures.take();
  return document;
}

}  // namespace

const char* to_string(ResultKind kind) {
  return kind == ResultKind::run ? "run" : "exploration";
}

Result load_result(const std::string& path) {
  Result result;
  result.path = file_of(path);
  result.json = io::read_json(result.path);
  const Json& json = result.json;
  const bool ours = json.is_object() && json.value("tool", Json()) == "partita";
  if (ours && json.value("kind", Json()) == "exploration") {
    result.kind = ResultKind::exploration;
  } else if (!ours || !json.contains("accuracy") || !json.contains("placement")) {
    throw Error(fmt::format("{}: neither a {} nor an {} of partita", result.path, kSummaryFile,
                            kExploreFile));
  }
  return result;
}

Json compare(const Result& a, const Result& b) {
  if (a.kind != b.kind) {
    throw Error(fmt::format("{} is of a {}, {} of a {}: expected two of one kind", a.path,
                            to_string(a.kind), b.path, to_string(b.kind)));
  }
  Json document{{"kind", to_string(a.kind)},
                {"a", {{"file", a.path}, {"partial", a.json.value("partial", false)}}},
                {"b", {{"file", b.path}, {"partial", b.json.value("partial", false)}}}};
  try {
    document.update(a.kind == ResultKind::run ? compare_runs(a.json, b.json)
                                              : compare_explorations(a.json, b.json));
  } catch (const Json::exception& error) {
    // Written by another version, or by hand.
    throw Error(fmt::format("{} and {} cannot be compared: {}", a.path, b.path, error.what()));
  }
  return document;
}

}  // namespace partita::app
