#include "host/app/depth_report.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace partita::app {
namespace {

using depth::Parameter;
using depth::ParameterKind;

Json value_json(const Parameter& parameter, const depth::DepthParameters& parameters) {
  const double value = parameter.get(parameters);
  if (parameter.kind == ParameterKind::flag) return value != 0;
  if (parameter.kind == ParameterKind::integer) return static_cast<std::int64_t>(value);
  return value;
}

struct Range {
  double least = 0, most = 0;
};

/// Of the map's disparities, px; nothing if it is empty.
std::optional<Range> disparity_range(const depth::DisparityMap& map) {
  std::optional<Range> range;
  for (const std::uint16_t value : map.values) {
    if (value == 0) continue;
    const double pixels = value / 256.0;
    if (!range) range = Range{pixels, pixels};
    range->least = std::min(range->least, pixels);
    range->most = std::max(range->most, pixels);
  }
  return range;
}

Json accuracy_json(const DepthReport& report) {
  const depth::Evaluation& e = *report.evaluation;
  Json json{{"truth", report.truth_path}, {"format", report.truth_format}};
  if (!report.mask_path.empty()) json["mask"] = report.mask_path;
  json["pixels_with_truth"] = e.with_truth;
  json["pixels_compared"] = e.compared;
  json["density"] = e.density();
  json["bad1_percent"] = e.bad1_percent();
  json["bad3_percent"] = e.bad3_percent();
  json["mean_error_px"] = e.mean_error_px();
  json["bad1_or_missing_percent"] = e.bad1_or_missing_percent();
  json["bad3_or_missing_percent"] = e.bad3_or_missing_percent();
  return json;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string range_text(const Parameter& parameter) {
  if (parameter.kind == ParameterKind::flag) return "on, off";
  return fmt::format("{}..{}", parameter.least, parameter.most);
}

}  // namespace

Json to_json(const DepthReport& report) {
  const runtime::Device& device = report.session.device();
  Json json;
  json["left"] = report.pair.left_path;
  json["right"] = report.pair.right_path;
  json["width"] = report.map.width;
  json["height"] = report.map.height;
  json["machine"] = report.machine;
  json["device"] = device.name;
  json["charged_variant"] = to_string(report.session.charged());
  json["executed_variant"] = to_string(report.session.executed());
  json["setting"] = report.setting;
  for (const Parameter& parameter : depth::parameter_table()) {
    json["parameters"][std::string(parameter.name)] = value_json(parameter, report.parameters);
  }
  json["support_points"] = report.map.counts.support_points;
  json["density"] = report.map.density();
  if (const auto range = disparity_range(report.map)) {
    json["disparity_px"] = {{"least", range->least}, {"most", range->most}};
  }
  if (report.evaluation) json["accuracy"] = accuracy_json(report);
  if (report.predicted_ms) json["predicted"] = {{"ms", *report.predicted_ms}};
  json["measured"] = {{"ms", median(report.times_ms)}, {"each_ms", report.times_ms}};
  json["conversions"] = report.pair.conversions;
  json["warnings"] = report.warnings;
  json["files"] = report.files;
  return json;
}

std::string to_text(const DepthReport& report) {
  const depth::DisparityMap& map = report.map;
  std::string text =
      fmt::format("{} x {} on {}, setting {}, disparities up to {} px\n", map.width, map.height,
                  report.session.device().name, report.setting, report.parameters.max_disparity);
  const auto range = disparity_range(map);
  text += fmt::format("map        {:.1f} % of the pixels have a disparity{}; {} support points\n",
                      100 * map.density(),
                      range ? fmt::format(", {:.2f} to {:.2f} px", range->least, range->most) : "",
                      map.counts.support_points);
  if (report.evaluation) {
    const depth::Evaluation& e = *report.evaluation;
    text += fmt::format(
        "accuracy   density {:.1f} %, bad-1 {:.2f} %, bad-3 {:.2f} %, mean error {:.2f} px\n"
        "           over {} pixels of {} ({}){}\n",
        100 * e.density(), e.bad1_percent(), e.bad3_percent(), e.mean_error_px(), e.with_truth,
        report.truth_path, report.truth_format,
        report.mask_path.empty() ? "" : fmt::format(" within {}", report.mask_path));
  }
  if (report.predicted_ms) text += fmt::format("predicted  {:.2f} ms\n", *report.predicted_ms);
  const std::size_t times = report.times_ms.size();
  text += fmt::format("measured   {:.1f} ms on this computer, {}\n", median(report.times_ms),
                      times == 1 ? "once" : fmt::format("median of {}", times));
  if (!report.files.empty()) text += fmt::format("written    {}\n", fmt::join(report.files, ", "));
  return text;
}

Json parameters_json() {
  Json list = Json::array();
  for (const Parameter& parameter : depth::parameter_table()) {
    Json item{{"name", parameter.name}, {"unit", parameter.unit}};
    if (parameter.kind != ParameterKind::flag) {
      item["least"] = parameter.least;
      item["most"] = parameter.most;
    }
    for (const std::string_view name : depth::kSettings) {
      item[std::string(name)] = value_json(parameter, depth::setting(name));
    }
    item["meaning"] = parameter.meaning;
    list.push_back(std::move(item));
  }
  return {{"parameters", std::move(list)}};
}

std::string parameters_text(const Console& console) {
  std::vector<std::string> header{"parameter", "unit", "range"};
  header.insert(header.end(), depth::kSettings.begin(), depth::kSettings.end());
  header.emplace_back("meaning");
  Table table(header);
  for (const Parameter& parameter : depth::parameter_table()) {
    std::vector<std::string> row{std::string(parameter.name), std::string(parameter.unit),
                                 range_text(parameter)};
    for (const std::string_view name : depth::kSettings) {
      row.push_back(depth::value_text(parameter, depth::setting(name)));
    }
    row.emplace_back(parameter.meaning);
    table.add(std::move(row));
  }
  return table.to_string(console.colour());
}

}  // namespace partita::app
